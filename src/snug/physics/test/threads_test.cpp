// Threads: a world stepped on several has the same bytes as on one.
#include <gtest/gtest.h>

#include <memory>

#include "scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics {
namespace {

using namespace test;

/// Boxes that fall onto a plane in heaps beside each other: islands of every size, more than are solved on one thread.
WorldModel heaps(int count, int height) {
  Rng rng(5);
  std::vector<BodyModel> boxes;
  for (int heap = 0; heap < count; ++heap) {
    for (int i = 0; i < height; ++i) {
      BodyModel body = box({0.1, 0.12, 0.08}, 0.3, {0.4 * heap, rng.uniform(-0.02, 0.02), 0.06 + 0.13 * i});
      body.X_WB.R = exp_rotation(Vector3(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-3.0, 3.0)));
      boxes.push_back(body);
    }
  }
  WorldModel model = on_plane({0.3, 0.1, 0.0, 0.0}, boxes);
  model.settings.sleep.enabled = true;
  return model;
}

TEST(Threads, DoNotChangeTheBytes) {
  const WorldModel model = heaps(24, 6);
  WorldState one = make_state(model), many = make_state(model), turns = make_state(model);
  Workspace work_one(model), work_many(model, 3), work_turns(model, 2);
  int most = 0;
  for (int i = 0; i < 700; ++i) {
    const StepReport report = step(model, {}, one, work_one);
    const StepReport same = step(model, {}, many, work_many);
    (void)step(model, {}, turns, i % 2 == 0 ? work_one : work_turns);  // a workspace that does not know the state
    most = std::max(most, report.contacts);
    ASSERT_EQ(report.status, same.status);
    ASSERT_EQ(report.residual, same.residual);
    ASSERT_EQ(report.sweeps, same.sweeps);
    ASSERT_EQ(report.worst_penetration, same.worst_penetration);
    ASSERT_TRUE(one == many) << "step " << i;
  }
  EXPECT_TRUE(one == turns);
  EXPECT_GT(most, 400);  // enough to be shared
}

/// Enough bodies for every loop to be shared: heaps that fall, boxes that lie and fall asleep, others that are
/// thrown onto them with spin, and last of all a kinematic bar that sweeps along one row of the sleepers.
WorldModel crowd() {
  Rng rng(11);
  std::vector<BodyModel> bodies;
  const auto place = [](int i, double z) { return Vector3(0.4 * (i % 15) - 3.0, 0.4 * (i / 15) - 3.0, z); };
  for (int i = 0; i < 60; ++i) {  // heaps
    for (int layer = 0; layer < 7; ++layer) {
      BodyModel body = box({0.1, 0.12, 0.08}, 0.3, place(i, 0.06 + 0.13 * layer));
      body.X_WB.R = exp_rotation(Vector3(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-3.0, 3.0)));
      bodies.push_back(body);
    }
  }
  for (int i = 60; i < 225; ++i) bodies.push_back(box({0.2, 0.2, 0.1}, 0.5, place(i, 0.05)));
  for (int i = 100; i < 160; ++i) {
    const Vector3 size(rng.uniform(0.03, 0.16), rng.uniform(0.03, 0.16), rng.uniform(0.03, 0.16));
    bodies.push_back(box(size, 0.2, place(i, 0.3 + 0.01 * (i % 20))));
    bodies.back().name = "thrown";
  }
  bodies.push_back(box({0.05, 0.3, 0.1}, 1.0, {-3.4, 2.6, 0.06}));
  bodies.back().kind = BodyKind::Kinematic;
  WorldModel model = on_plane({0.3, 0.1, 0.0, 0.0}, bodies);
  model.settings.sleep.enabled = true;
  model.settings.sleep.time = 0.03;
  model.settings.dt = 4e-3;
  return model;
}

struct Crowd {
  const WorldModel& model;
  WorldState state;
  Workspace work;
  StepReport report;
  Crowd(const WorldModel& m, int threads) : model(m), state(make_state(m)), work(m, threads) {
    Rng rng(12);
    for (std::size_t i = 0; i < m.bodies.size(); ++i) {
      if (m.bodies[i].name != "thrown") continue;
      state.bodies[i].velocity = {rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), -1.0};
      state.bodies[i].angular_velocity = {rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0)};
    }
  }
  void advance(int index) {
    const BodyId bar{static_cast<int>(model.bodies.size()) - 1};
    Pose X_WB_end = model.bodies.back().X_WB;
    X_WB_end.p.x() += 0.012 * std::max(0, index - 50);
    const KinematicTarget target{bar, X_WB_end};
    WorldInput input;
    input.kinematic = {&target, 1};
    report = step(model, input, state, work);
  }
  [[nodiscard]] long sleepers() const {
    return std::count_if(state.bodies.begin(), state.bodies.end(), [](const auto& b) { return b.sleep_group >= 0; });
  }
  [[nodiscard]] bool has_swept() {
    const auto& patches = work.scratch().patches;
    return std::any_of(patches.begin(), patches.end(), [](const auto& patch) { return patch.is_swept; });
  }
};

TEST(Threads, DoNotChangeTheBytesOfACrowdThatSleepsWakesAndIsSwept) {
  const WorldModel model = crowd();
  ASSERT_GE(model.bodies.size(), 600U);
  Crowd one(model, 1);
  std::vector<std::unique_ptr<Crowd>> many;
  for (const int threads : {2, 3, 5}) many.push_back(std::make_unique<Crowd>(model, threads));
  long most_asleep = 0, woken = 0;
  std::size_t most_pairs = 0;
  int swept = 0;
  for (int i = 0; i < 200; ++i) {
    const long asleep = one.sleepers();
    one.advance(i);
    for (const auto& crowd : many) {
      crowd->advance(i);
      ASSERT_TRUE(one.state == crowd->state) << "step " << i << ", " << crowd->work.scratch().pool.size() << " threads";
      ASSERT_EQ(one.report.residual, crowd->report.residual);
      ASSERT_EQ(one.report.contacts, crowd->report.contacts);
      ASSERT_EQ(one.report.worst_penetration, crowd->report.worst_penetration);
      ASSERT_EQ(one.report.worst_penetration_pair, crowd->report.worst_penetration_pair);
      ASSERT_EQ(one.work.contacts().size(), crowd->work.contacts().size());
    }
    most_asleep = std::max(most_asleep, one.sleepers());
    woken += std::max(0L, asleep - one.sleepers());
    most_pairs = std::max(most_pairs, one.state.pairs.size());
    swept += one.has_swept() ? 1 : 0;
  }
  EXPECT_GT(most_asleep, 50);  // what makes the scene worth its time
  EXPECT_GT(woken, 10);
  EXPECT_GT(swept, 5);
  EXPECT_GT(most_pairs, internal::kLeastShared);
}

TEST(Threads, NameTheSameBodyWhenSomethingIsNoNumber) {
  const WorldModel model = heaps(24, 4);
  for (const int threads : {1, 3}) {
    SCOPED_TRACE(threads);
    WorldState state = make_state(model);
    Workspace work(model, threads);
    for (int i = 0; i < 200; ++i) (void)step(model, {}, state, work);
    state.bodies[40].velocity.x() = std::numeric_limits<double>::quiet_NaN();
    state.bodies[70].velocity.x() = std::numeric_limits<double>::infinity();
    const StepReport report = step(model, {}, state, work);
    EXPECT_EQ(report.status, StepStatus::NotFinite);
    EXPECT_EQ(report.culprit, BodyId{40});
  }
}

}  // namespace
}  // namespace snug::physics
