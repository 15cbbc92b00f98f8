// Sleep: who wakes a sleeper, what a sleeping world reports, and that sleeping does not change results.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics::test {
namespace {

/// Two stacks of two boxes 1 m apart on a plane: bodies 1, 2 and 3, 4; body 5 a kinematic plate far above; 6 a
/// kinematic pusher beside the first stack.
WorldModel two_stacks() {
  WorldModel model = world({0.2, 0.0, 0.0, 0.0}, {0.2, 0.0, 0.0, 0.0});
  model.bodies.push_back(fixed_box({20.0, 20.0, 1.0}, {0.0, 0.0, -0.5}));
  for (const double x : {0.0, 1.0}) {
    model.bodies.push_back(box(kBox, 0.5, {x, 0.0, 0.05}));
    model.bodies.push_back(box(kBox, 0.5, {x, 0.0, 0.15}));
  }
  for (const Vector3& p : {Vector3(0.0, 0.0, 3.0), Vector3(-0.3, 0.0, 0.05)}) {
    BodyModel plate = fixed_box({0.1, 0.1, 0.05}, p);
    plate.kind = BodyKind::Kinematic;
    model.bodies.push_back(plate);
  }
  model.settings.sleep.enabled = true;
  model.finalize();
  return model;
}

bool is_asleep(const Simulation& run, int body) {
  return run.state.bodies[static_cast<std::size_t>(body)].sleep_group >= 0;
}

class SleepingStacks : public testing::Test {
 protected:
  SleepingStacks() : model_(two_stacks()), run_(model_) { run_.steps(400); }
  void SetUp() override {
    for (int i = 1; i <= 4; ++i) ASSERT_TRUE(is_asleep(run_, i)) << i;
  }
  /// Only the first stack, and all of it.
  void expect_first_awake() {
    EXPECT_FALSE(is_asleep(run_, 1));
    EXPECT_FALSE(is_asleep(run_, 2));
    EXPECT_TRUE(is_asleep(run_, 3));
    EXPECT_TRUE(is_asleep(run_, 4));
  }
  StepReport step_to(BodyId body, const Vector3& p) {
    const KinematicTarget target{body, {Matrix3::Identity(), p}};
    WorldInput input;
    input.kinematic = {&target, 1};
    return run_.step(input);
  }

  WorldModel model_;
  Simulation run_;
};

TEST_F(SleepingStacks, ReportNoContactsAndNobodyAwakeAndDoNotMove) {
  const WorldState before = run_.state;
  for (int i = 0; i < 100; ++i) {
    const StepReport report = run_.step();
    ASSERT_EQ(report.status, StepStatus::Converged);
    ASSERT_EQ(report.awake, 0);
    ASSERT_EQ(report.contacts, 0);
    ASSERT_EQ(report.sweeps, 0);
    ASSERT_TRUE(run_.work.contacts().empty());
  }
  EXPECT_EQ(run_.state.step_index, before.step_index + 100);
  EXPECT_TRUE(run_.state.bodies == before.bodies);
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(run_.body(i).velocity, Vector3(Vector3::Zero()));
    EXPECT_EQ(run_.body(i).angular_velocity, Vector3(Vector3::Zero()));
  }
}

TEST_F(SleepingStacks, AreSeparateGroups) {
  EXPECT_EQ(run_.body(1).sleep_group, run_.body(2).sleep_group);
  EXPECT_EQ(run_.body(3).sleep_group, run_.body(4).sleep_group);
  EXPECT_NE(run_.body(1).sleep_group, run_.body(3).sleep_group);
}

TEST_F(SleepingStacks, WakeAsAGroupWhenOneIsMoved) {
  set_pose(model_, run_.state, BodyId{2}, {Matrix3::Identity(), Vector3(0.01, 0.0, 0.15)});
  expect_first_awake();
  EXPECT_EQ(run_.step().awake, 2);
}

TEST_F(SleepingStacks, WakeAsAGroupWhenOneIsGivenAVelocity) {
  set_twist(model_, run_.state, BodyId{1}, Twist{Vector3(0.1, 0.0, 0.0), Vector3::Zero()});
  expect_first_awake();
  EXPECT_EQ(run_.step().awake, 2);
}

TEST_F(SleepingStacks, FallWhenTheirSupportIsTakenAway) {
  set_present(run_.state, BodyId{1}, false);
  EXPECT_EQ(run_.step().awake, 1);
  run_.steps(100);
  EXPECT_LT(run_.body(2).p_WBcm.z(), 0.15 - 0.04);  // 0.5 g t^2 = 49 mm in 0.1 s
  EXPECT_TRUE(is_asleep(run_, 3));
}

TEST_F(SleepingStacks, WakeByAWrenchOnOneOfThemAndSleepAgainAfterIt) {
  const ExternalWrench wrench{BodyId{2}, {Vector3(0.0, 0.0, 0.1), Vector3::Zero()}};
  WorldInput input;
  input.wrenches = {&wrench, 1};
  EXPECT_EQ(run_.step(input).awake, 2);
  for (int i = 0; i < 400; ++i) ASSERT_EQ(run_.step(input).awake, 2);  // as long as it acts
  run_.steps(300);
  EXPECT_TRUE(is_asleep(run_, 1));
}

struct Nothing final : ForceElement {
  [[nodiscard]] ElementResponse evaluate(const ElementQuery&) const noexcept override { return {}; }
};

TEST_F(SleepingStacks, WakeByAForceElementOnOneOfThem) {
  const Nothing element;
  const ElementUse use{&element, BodyId{5}, {}, BodyId{1}};
  WorldInput input;
  input.elements = {&use, 1};
  for (int i = 0; i < 400; ++i) ASSERT_EQ(run_.step(input).awake, 2);
  EXPECT_TRUE(is_asleep(run_, 3));
}

TEST_F(SleepingStacks, SleepOnWhileAKinematicBodyMovesElsewhere) {
  for (int i = 1; i <= 300; ++i) {
    const StepReport report = step_to(BodyId{5}, Vector3(0.001 * i, 0.0, 3.0));
    ASSERT_EQ(report.awake, 0) << i;
    ASSERT_EQ(report.contacts, 0) << i;
  }
}

TEST_F(SleepingStacks, WakeWhenAMovingKinematicBodyTouchesThemAndArePushed) {
  // Its face is at x = -0.25, that of the box at -0.1; 0.2 m/s: it arrives after 0.75 s.
  int woken = -1;
  for (int i = 1; i <= 1000; ++i) {
    const int awake = step_to(BodyId{6}, Vector3(-0.3 + 2e-4 * i, 0.0, 0.05)).awake;
    if (woken < 0 && awake > 0) woken = i;
    if (woken < 0) continue;
    ASSERT_EQ(awake, 2) << i;  // what it touches stays awake
  }
  EXPECT_NEAR(woken, 750, 1);
  // Pushed for 0.25 s at 0.2 m/s: 50 mm, less the positions' slop.
  EXPECT_NEAR(run_.body(1).p_WBcm.x(), 0.05, 1e-6);
  EXPECT_TRUE(is_asleep(run_, 3));
}

TEST_F(SleepingStacks, SleepAgainBesideAPusherThatStandsStill) {
  for (int i = 1; i <= 800; ++i) (void)step_to(BodyId{6}, Vector3(-0.3 + 2e-4 * i, 0.0, 0.05));
  for (int i = 0; i < 500; ++i) (void)step_to(BodyId{6}, Vector3(-0.3 + 2e-4 * 800, 0.0, 0.05));
  EXPECT_EQ(run_.step().awake, 0);
}

TEST(Kinematic, CarriesABoxUpAndDownWithoutLosingIt) {
  WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
  BodyModel lift = fixed_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.05});
  lift.kind = BodyKind::Kinematic;
  model.bodies = {lift, box(kBox, 0.5, {0.0, 0.0, 0.05})};
  model.finalize();
  Simulation run(model);
  for (int i = 1; i <= 2000; ++i) {
    // Amplitude 20 mm at 3 Hz: 7.1 m/s^2, less than g.
    const double z = 0.02 * std::sin(2.0 * std::numbers::pi * 3.0 * i * 1e-3);
    const KinematicTarget target{BodyId{0}, {Matrix3::Identity(), Vector3(0.0, 0.0, z - 0.05)}};
    WorldInput input;
    input.kinematic = {&target, 1};
    ASSERT_EQ(run.step(input).status, StepStatus::Converged);
    // A step ends with the table's mean velocity in it, one with a = 7.1 m/s^2 more or less than before: dt^2 a / 2.
    // A gap that gravity would not close within a step is left: dt^2 g / 2.
    ASSERT_NEAR(run.body(1).p_WBcm.z(), z + 0.05, 0.5 * (7.2 + 9.81) * 1e-6) << i;
  }
}

TEST(Kinematic, ThatStoodUpInOneStrideIsStillFoundByWhatFallsOnIt) {
  // Moves of up to 60 mm a step end outside of the box that the pair search keeps; then it stands without a target.
  for (const double stride : {0.005, 0.013, 0.03, 0.06}) {
    for (int strides = 1; strides <= 4; ++strides) {
      SCOPED_TRACE(testing::Message() << strides << " strides of " << stride);
      WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
      BodyModel table = fixed_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.05});
      table.kind = BodyKind::Kinematic;
      const double top = stride * strides;
      model.bodies = {table, box(kBox, 0.5, {0.0, 0.0, top + 0.05 + 0.1})};
      model.settings.dt = 4e-3;
      model.finalize();
      Simulation run(model);
      for (int i = 1; i <= strides; ++i) {
        const KinematicTarget target{BodyId{0}, {Matrix3::Identity(), Vector3(0.0, 0.0, stride * i - 0.05)}};
        WorldInput input;
        input.kinematic = {&target, 1};
        (void)run.step(input);
      }
      double deepest = 0.0;
      for (int i = 0; i < 200; ++i) {
        const StepReport report = run.step();
        deepest = std::max({deepest, report.worst_penetration, top + 0.05 - run.body(1).p_WBcm.z()});
      }
      EXPECT_LE(deepest, 1e-6);  // overshoot of the landing step is mended within it
    }
  }
}

std::vector<BodyModel> heap(unsigned seed) {
  Rng rng = Rng(seed).split("heap");
  std::vector<BodyModel> boxes;
  for (int i = 0; i < 6; ++i) {
    boxes.push_back(box({0.105, 0.12, 0.108}, 0.26, {rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), 0.06 + 0.11 * i}));
    boxes.back().X_WB.R = exp_rotation(Vector3(0.0, 0.0, rng.uniform(-3.0, 3.0)));
  }
  return boxes;
}

TEST(Sleep, ChangesAHeapByLessThanItsThresholdsAllow) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    WorldModel awake = in_container(heap(seed));
    WorldModel asleep = awake;
    asleep.settings.sleep.enabled = true;
    Simulation a(awake), b(asleep);
    int first = -1;
    for (int i = 0; i < 4000; ++i) {
      (void)a.step();
      if (b.step().awake < 6 && first < 0) first = i;
    }
    EXPECT_GE(first, 0);
    for (int i = 5; i < 11; ++i) {
      // A group sleeps after 0.25 s below 1 mm/s: what still creeps would have come to rest within another such time.
      EXPECT_LT((a.body(i).p_WBcm - b.body(i).p_WBcm).norm(), 1e-3 * 0.25) << i;
    }
  }
}

TEST_F(SleepingStacks, LeaveAKinematicBodyThatStopsWithoutVelocity) {
  for (int i = 1; i <= 10; ++i) (void)step_to(BodyId{5}, Vector3(0.001 * i, 0.0, 3.0));
  EXPECT_NEAR(twist_of(model_, run_.state, BodyId{5}).linear.x(), 1.0, 1e-12);
  (void)step_to(BodyId{5}, Vector3(0.01, 0.0, 3.0));  // same pose as before: it stands
  EXPECT_EQ(twist_of(model_, run_.state, BodyId{5}).linear, Vector3(Vector3::Zero()));
}

TEST_F(SleepingStacks, LeaveAKinematicBodyWithoutATargetWithoutVelocity) {
  for (int i = 1; i <= 10; ++i) (void)step_to(BodyId{5}, Vector3(0.001 * i, 0.0, 3.0));
  (void)run_.step();  // no target: it stands still
  EXPECT_EQ(twist_of(model_, run_.state, BodyId{5}).linear, Vector3(Vector3::Zero()));
}

TEST_F(SleepingStacks, FallWhenTheGroundIsRemoved) {
  set_present(run_.state, BodyId{0}, false);
  run_.steps(100);
  EXPECT_LT(run_.body(1).p_WBcm.z(), 0.05 - 0.04);  // 0.5 g t^2 = 49 mm in 0.1 s
}

TEST_F(SleepingStacks, FallWhenTheGroundIsMovedAway) {
  set_pose(model_, run_.state, BodyId{0}, {Matrix3::Identity(), Vector3(0.0, 0.0, -1.5)});
  run_.steps(100);
  EXPECT_LT(run_.body(1).p_WBcm.z(), 0.05 - 0.04);  // as above
}

}  // namespace
}  // namespace snug::physics::test
