// Attacks on step(): input that is not a number or absurd, and states that share workspaces.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NotFinite, NamesTheLoneBodyWhoseStateIsNotANumber) {
  const WorldModel model = tall_stack();
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int part = 0; part < 4; ++part) {
      SCOPED_TRACE(testing::Message() << bad << " in part " << part);
      Simulation run(model);
      run.steps(5);
      if (part == 0) run.body(4).velocity.y() = bad;
      if (part == 1) run.body(4).angular_velocity.y() = bad;
      if (part == 2) run.body(4).p_WBcm.y() = bad;
      if (part == 3) run.body(4).quat_WB.x() = bad;
      const StepReport report = step_until_wrong(run);
      EXPECT_EQ(report.status, StepStatus::NotFinite);
      EXPECT_EQ(report.culprit, BodyId{4});
    }
  }
}

TEST(NotFinite, NamesTheBodyThatAWrenchWithoutNumberActsOn) {
  const WorldModel model = tall_stack();
  for (const int body : {4, 1, 2, 3}) {
    for (const bool is_torque : {false, true}) {
      SCOPED_TRACE(testing::Message() << "body " << body << (is_torque ? " torque" : " force"));
      Simulation run(model);
      run.steps(5);
      ExternalWrench wrench{BodyId{body}, {}};
      (is_torque ? wrench.wrench_W.torque : wrench.wrench_W.force).z() = kNaN;
      WorldInput input;
      input.wrenches = {&wrench, 1};
      const StepReport report = step_until_wrong(run, input);
      EXPECT_EQ(report.status, StepStatus::NotFinite);
      EXPECT_EQ(report.culprit, BodyId{body});
    }
  }
}

struct Broken final : ForceElement {
  [[nodiscard]] ElementResponse evaluate(const ElementQuery&) const noexcept override {
    ElementResponse response;
    response.wrench[2] = kNaN;
    return response;
  }
};

TEST(NotFinite, NamesTheBodyThatABrokenForceElementActsOn) {
  WorldModel model = tall_stack();
  BodyModel carrier = fixed_box({0.01, 0.01, 0.01}, {0.0, 0.0, 3.0});
  carrier.kind = BodyKind::Kinematic;
  model.bodies.push_back(carrier);
  model.finalize();
  const Broken element;
  for (const int body : {4, 1, 2, 3}) {
    Simulation run(model);
    run.steps(5);
    const ElementUse use{&element, BodyId{5}, {}, BodyId{body}};
    WorldInput input;
    input.elements = {&use, 1};
    const StepReport report = step_until_wrong(run, input);
    EXPECT_EQ(report.status, StepStatus::NotFinite);
    EXPECT_EQ(report.culprit, BodyId{body});
  }
}

TEST(LostBody, NamesWhatFliesAway) {
  const WorldModel model = tall_stack();
  for (const double speed : {1e7, 1e9, 1e100, 1e300}) {
    for (const Vector3& way : {Vector3(1.0, 0.0, 0.0), Vector3(0.3, -0.5, 0.8)}) {
      SCOPED_TRACE(speed);
      Simulation run(model);
      run.steps(5);
      set_twist(model, run.state, BodyId{4}, Twist{speed * way, Vector3::Zero()});
      const StepReport report = step_until_wrong(run);
      EXPECT_TRUE(report.status == StepStatus::LostBody || report.status == StepStatus::NotFinite);
      EXPECT_EQ(report.culprit, BodyId{4});
    }
  }
}

TEST(LostBody, IsNotWhatABodyThrownIntoTheGroundMakesOfTheOthers) {
  const WorldModel model = tall_stack();
  for (const double speed : {1e3, 1e6, 1e9}) {
    SCOPED_TRACE(speed);
    Simulation run(model);
    run.steps(5);
    set_twist(model, run.state, BodyId{4}, Twist{Vector3(0.0, 0.0, -speed), Vector3::Zero()});
    const StepReport report = step_until_wrong(run);
    if (report.culprit.is_valid()) {
      EXPECT_EQ(report.culprit, BodyId{4});
    }
    for (int i = 1; i <= 3; ++i) EXPECT_LT(run.body(i).velocity.norm(), 1.0) << i;
  }
}

TEST(AbsurdInput, DoesNotCrashAndLeavesFiniteStatesOrSaysSo) {
  const WorldModel model = tall_stack();
  Rng rng = Rng(21).split("absurd");
  const double sizes[] = {0.0, 1e-300, 1e-12, 1.0, 1e3, 1e6, 1e12, 1e200, 1e308, kInfinity, kNaN};
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    Simulation run(model);
    run.steps(2);
    const auto pick = [&] { return (rng.index(2) == 0 ? -1.0 : 1.0) * sizes[rng.index(std::size(sizes))]; };
    BodyState& body = run.body(1 + rng.index(4));
    Vector3& part = rng.index(2) == 0 ? body.velocity : body.angular_velocity;
    part[rng.index(3)] = pick();
    ExternalWrench wrench{BodyId{1 + rng.index(4)}, {}};
    wrench.wrench_W.force[rng.index(3)] = pick();
    wrench.wrench_W.torque[rng.index(3)] = pick();
    WorldInput input;
    input.wrenches = {&wrench, 1};
    const StepReport report = step_until_wrong(run, input);
    bool is_finite = true;
    for (const BodyState& b : run.state.bodies) {
      is_finite = is_finite && b.p_WBcm.allFinite() && b.velocity.allFinite() && b.angular_velocity.allFinite() &&
                  b.quat_WB.coeffs().allFinite();
    }
    if (!is_finite) {
      EXPECT_TRUE(report.status == StepStatus::NotFinite || report.status == StepStatus::LostBody);
      EXPECT_TRUE(report.culprit.is_valid());
    }
    if (report.status == StepStatus::Converged) {
      EXPECT_TRUE(std::isfinite(report.residual));
    }
  }
}

WorldModel drop(unsigned seed, bool sleeps = false) {
  Rng rng = Rng(seed).split("drop");
  std::vector<BodyModel> boxes;
  for (int i = 0; i < 7; ++i) {
    boxes.push_back(box({0.15, 0.12, 0.108}, 0.4, {rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), 0.1 + 0.14 * i}));
    boxes.back().X_WB.R = exp_rotation(Vector3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-3.0, 3.0)));
  }
  WorldModel model = in_container(boxes);
  model.settings.sleep.enabled = sleeps;
  return model;
}

/// A state with other velocities: another future of the same model.
WorldState variant(const WorldModel& model, int k) {
  WorldState state = make_state(model);
  Rng rng = Rng(31).split(std::to_string(k));
  for (int i = 5; i < static_cast<int>(model.bodies.size()); ++i) {
    const Vector3 v(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5));
    set_twist(model, state, BodyId{i}, Twist{v, 3.0 * v});
  }
  return state;
}

TEST(Workspace, SharedByTwoStatesGivesWhatEachGivesAlone) {
  for (const bool sleeps : {false, true}) {
    const WorldModel model = drop(1, sleeps);
    WorldState a = variant(model, 0), b = variant(model, 1), a_alone = a, b_alone = b;
    Workspace shared(model), for_a(model), for_b(model);
    for (int i = 0; i < 900; ++i) {
      const StepReport ra = step(model, {}, a, shared);
      const StepReport rb = step(model, {}, b, shared);
      const StepReport ra_alone = step(model, {}, a_alone, for_a);
      const StepReport rb_alone = step(model, {}, b_alone, for_b);
      ASSERT_EQ(ra.residual, ra_alone.residual) << i;
      ASSERT_EQ(rb.sweeps, rb_alone.sweeps) << i;
      ASSERT_EQ(hash_of(a), hash_of(a_alone)) << i;
      ASSERT_EQ(hash_of(b), hash_of(b_alone)) << i;
    }
    EXPECT_TRUE(a == a_alone);
    EXPECT_TRUE(b == b_alone);
  }
}

TEST(Workspace, ServesManyCopiesOfOneStateInAnyOrder) {
  const WorldModel model = drop(2);
  Simulation alone(model);
  alone.steps(300);
  std::vector<WorldState> copies(6, alone.state);
  std::vector<int> done(6, 0);
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < 120; ++i) {
    (void)alone.step();
    hashes.push_back(hash_of(alone.state));
  }
  Workspace work(model), other(model);
  Rng rng = Rng(41).split("order");
  for (int i = 0; i < 600; ++i) {
    const auto k = static_cast<std::size_t>(rng.index(6));
    if (done[k] >= 120) continue;
    (void)step(model, {}, copies[k], rng.index(3) == 0 ? other : work);
    ASSERT_EQ(hash_of(copies[k]), hashes[static_cast<std::size_t>(done[k])]) << "copy " << k << ", step " << done[k];
    ++done[k];
  }
}

TEST(Workspace, GoesBackToASnapshotAndRepeatsItself) {
  const WorldModel model = drop(3, true);
  Simulation run(model);
  for (int round = 0; round < 5; ++round) {
    run.steps(150);
    const WorldState snapshot = run.state;
    run.steps(60);
    const WorldState first = run.state;
    run.state = snapshot;  // the same workspace, and the same memory
    run.steps(60);
    ASSERT_TRUE(run.state == first) << round;
  }
}

TEST(Workspace, KnowsNothingOfAStateThatWasEditedBetweenSteps) {
  const WorldModel model = drop(4);
  Simulation run(model);
  run.steps(500);
  for (int round = 0; round < 40; ++round) {
    WorldState copy = run.state;
    const BodyId body{5 + round % 7};
    for (WorldState* state : {&run.state, &copy}) {
      BodyState& b = state->bodies[static_cast<std::size_t>(body.index)];
      switch (round % 5) {
        case 0:
          b.p_WBcm.z() += 0.01;  // by hand, past set_pose
          break;
        case 1:
          b.velocity.x() += 0.3;
          break;
        case 2: {
          Pose X_WB = pose_of(model, *state, body);
          X_WB.p.z() += 0.05;
          set_pose(model, *state, body, X_WB);
          break;
        }
        case 3:
          set_present(*state, body, false);
          break;
        default:
          for (std::size_t i = 5; i < 12; ++i) set_present(*state, BodyId{static_cast<int>(i)}, true);
          if (state->pairs.size() > 0) state->pairs[0].is_known = false;
      }
    }
    Workspace fresh(model);
    for (int i = 0; i < 10; ++i) {
      (void)run.step();
      (void)step(model, {}, copy, fresh);
      ASSERT_EQ(hash_of(run.state), hash_of(copy)) << "round " << round << ", step " << i;
    }
    ASSERT_TRUE(run.state == copy);
  }
}

TEST(Workspace, MovedOrReplacedGivesTheSameBytes) {
  const WorldModel model = drop(5);
  Simulation run(model), other(model);
  for (int i = 0; i < 300; ++i) {
    if (i % 7 == 0) {
      Workspace moved(std::move(other.work));
      other.work = std::move(moved);
    }
    if (i % 11 == 0) other.work = Workspace(model);
    (void)run.step();
    (void)other.step();
    ASSERT_EQ(hash_of(run.state), hash_of(other.state)) << i;
  }
}

}  // namespace
}  // namespace snug::physics::test
