// Swept contacts: bodies that turn by much of a radian in a step do not end it inside others.
#include <gtest/gtest.h>

#include <algorithm>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics {
namespace {

using namespace test;

Vector3 drawn(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Boxes thrown into the container at 3 m/s and up to 100 rad/s: 0.5 rad in a step of 5 ms.
WorldModel thrown(int count, double dt) {
  Rng rng = Rng(3).split("thrown");
  std::vector<BodyModel> boxes;
  for (int i = 0; i < count; ++i) {
    const Vector3 size(rng.uniform(0.03, 0.16), rng.uniform(0.03, 0.16), rng.uniform(0.03, 0.16));
    BodyModel body = box(size, rng.uniform(0.05, 1.0), {0.14 * (i % 3) - 0.14, 0.1 * (i % 2), 0.12 + 0.2 * i});
    body.X_WB.R = exp_rotation(drawn(rng, 2.0));
    boxes.push_back(body);
  }
  WorldModel model = in_container(boxes);
  model.settings.dt = dt;
  model.settings.tolerance = 1e-5;
  return model;
}

void throw_boxes(const WorldModel& model, std::uint64_t seed, WorldState& state) {
  Rng rng = Rng(seed).split("throw");
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].kind != BodyKind::Dynamic) continue;
    state.bodies[i].velocity = Vector3(0.0, 0.0, -3.0) + drawn(rng, 1.0);
    state.bodies[i].angular_velocity = drawn(rng, 58.0);
  }
}

// More than 0.2 mm of overlap asks for contacts, three times at most; 3 mm is what decision 0029 aims at. Without swept
// contacts five of the first eight seeds are deeper, up to 19 mm.
TEST(SweptContacts, KeepCornersOfThrownBoxesOutOfOthers) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(seed);
    const WorldModel model = thrown(8, 5e-3);
    Simulation run(model);
    throw_boxes(model, seed, run.state);
    double deepest = 0.0;
    for (int i = 0; i < 160; ++i) {
      const StepReport report = run.step();
      ASSERT_EQ(report.status, StepStatus::Converged) << "step " << i;
      deepest = std::max(deepest, report.worst_penetration);
    }
    EXPECT_LT(deepest, 3e-3);
  }
}

// An edge over an edge: without contact when seen at the start of the step, since a seam looks like that, and two
// millimetres deep at its end.
TEST(SweptContacts, KeepABoxOutOfTheCornerThatItWasFlushWith) {
  for (const double gap : {1e-4, 1e-3}) {
    for (const double height : {-2e-5, 0.0, 2e-5}) {
      SCOPED_TRACE(gap);
      BodyModel tile = fixed_box({0.2, 0.6, 0.04}, {0.0, 0.0, -0.02});
      WorldModel model =
          on_plane({0.3, 0.0, 0.0, 0.0}, {tile, box({0.1, 0.08, 0.06}, 1.0, {0.15 + gap, 0, 0.03 + height})});
      model.bodies[0].X_WB.p.z() = -5.0;  // out of the way
      model.settings.dt = 2e-3;
      Simulation run(model);
      run.body(2).velocity = Vector3(-1.0, 0.0, -1.0);
      double deepest = 0.0;
      for (int i = 0; i < 10; ++i) deepest = std::max(deepest, run.step().worst_penetration);
      EXPECT_LT(deepest, 1.1e-4);
    }
  }
}

TEST(SweptContacts, GiveTheSameBytesFromASnapshotAndOnAnyWorkspace) {
  const WorldModel model = thrown(12, 5e-3);
  Simulation run(model);
  throw_boxes(model, 7, run.state);
  WorldState copy = run.state;
  Workspace one(model), other(model, 2);
  for (int i = 0; i < 200; ++i) {
    (void)run.step();
    (void)step(model, {}, copy, i % 3 == 0 ? other : one);
    if (i == 60) copy = WorldState(run.state);
    ASSERT_EQ(hash_of(run.state), hash_of(copy)) << "step " << i;
  }
}

/// Bodies 1 and 2: a column, and a box thrown at it from the side that stays clear of the ground.
struct Throw {
  WorldModel model;
  Vector3 velocity, angular;
};

Throw at_a_column(int seed, bool has_gravity) {
  Rng rng = Rng(static_cast<std::uint64_t>(seed)).split("at a column");
  BodyModel thrown = box({0.2, 0.03, 0.05}, 0.2, {rng.uniform(-0.03, 0.03), -0.3, rng.uniform(0.35, 0.45)});
  thrown.X_WB.R = exp_rotation(drawn(rng, 2.0));
  Throw result;
  result.model = on_plane({0.3, 0.0, 0.0, 0.0}, {box({0.1, 0.1, 0.5}, 0.5, {0.0, 0.0, 0.25}), thrown});
  result.model.settings.dt = 5e-3;
  result.model.settings.tolerance = 1e-9;
  if (!has_gravity) result.model.gravity.setZero();
  result.velocity = Vector3(0.0, 2.0, 0.5);
  // About one of its axes: a spin that changes by itself within the step is another matter.
  result.angular = result.model.bodies[2].X_WB.R.col(rng.index(3)) * rng.uniform(-100.0, 100.0);
  return result;
}

TEST(SweptContacts, KeepLinearMomentum) {
  int meetings = 0;
  for (int seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Throw scene = at_a_column(seed, false);
    scene.model.bodies[0].X_WB.p.z() = -5.0;  // out of the way
    Simulation run(scene.model);
    run.body(2).velocity = scene.velocity;
    run.body(2).angular_velocity = scene.angular;
    for (int k = 0; k < 60; ++k) {
      ASSERT_EQ(run.step().status, StepStatus::Converged);
      // Impulses enter both bodies alike: equal up to rounding of some tens of additions.
      const Vector3 momentum = 0.5 * run.body(1).velocity + 0.2 * run.body(2).velocity;
      ASSERT_LT((momentum - 0.2 * scene.velocity).norm(), 1e-13);
    }
    meetings += run.body(1).velocity.norm() > 0.01 ? 1 : 0;
  }
  EXPECT_GT(meetings, 200);
}

TEST(SweptContacts, WakeWhatSleeps) {
  int blows = 0;
  for (int seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Throw scene = at_a_column(seed, true);
    scene.model.settings.sleep.enabled = true;
    Simulation run(scene.model);
    set_present(run.state, BodyId{2}, false);
    run.steps(100);
    ASSERT_GE(run.body(1).sleep_group, 0);
    run.body(2).is_present = true;
    run.body(2).velocity = scene.velocity;
    run.body(2).angular_velocity = scene.angular;
    for (int k = 0; k < 30; ++k) {
      (void)run.step();
      if ((run.body(2).velocity - scene.velocity).head<2>().norm() < 1e-6) continue;  // gravity changes z alone
      EXPECT_LT(run.body(1).sleep_group, 0) << "step " << k;
      EXPECT_GT(run.body(1).velocity.norm(), 1e-6) << "step " << k;
      ++blows;
      break;
    }
  }
  EXPECT_GT(blows, 200);
}

}  // namespace
}  // namespace snug::physics
