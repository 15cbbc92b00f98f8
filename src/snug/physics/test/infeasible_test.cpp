// Steps that no velocities solve: they are known as such, end early, and other steps are never taken for one.
#include <gtest/gtest.h>

#include <vector>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics::test {
namespace {

const Vector3 kPressed(0.1, 0.1, 0.1);

/// Bodies 0 and 1: floor and a lid that comes down; then boxes.
WorldModel press_of(const std::vector<BodyModel>& boxes, double stiffness = 0.0) {
  const ContactLaw law{0.3, 0.0, stiffness, 0.0};
  WorldModel model = world(law, law);
  BodyModel lid = fixed_box({0.8, 0.8, 0.05}, {0.0, 0.0, 0.125});
  lid.kind = BodyKind::Kinematic;
  model.bodies = {fixed_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.05}), lid};
  model.bodies.insert(model.bodies.end(), boxes.begin(), boxes.end());
  model.finalize();
  return model;
}

/// A step after which the lower face of the lid is at this height, m, turned by `tilt` about y.
StepReport lower_to(Simulation& run, double height, double tilt = 0.0) {
  const KinematicTarget target{BodyId{1}, {exp_rotation(Vector3(0.0, tilt, 0.0)), Vector3(0.0, 0.0, height + 0.025)}};
  WorldInput input;
  input.kinematic = {&target, 1};
  return run.step(input);
}

TEST(Infeasible, APressSaysSoFromTheStepOnInWhichItMeetsTheBox) {
  const WorldModel model = press_of({box(kPressed, 0.5, {0.0, 0.0, 0.05})});
  Simulation run(model);
  (void)lower_to(run, 0.1);  // put in place
  for (int i = 0; i < 10; ++i) {
    const StepReport report = lower_to(run, 0.1);
    ASSERT_EQ(report.status, StepStatus::Converged) << i;
    ASSERT_FALSE(report.is_infeasible) << i;
  }
  int most = 0;
  for (int i = 1; i <= 100; ++i) {
    const StepReport report = lower_to(run, 0.1 - 1e-5 * i);
    ASSERT_EQ(report.status, StepStatus::NotConverged) << i;
    ASSERT_TRUE(report.is_infeasible) << i;
    // The least violation of both faces is half of the 10 mm/s of the lid; sweeps leave all of it, and what gravity
    // asks of the floor in a step, at one of them.
    EXPECT_GE(report.residual, 0.0049) << i;
    EXPECT_LE(report.residual, 0.0199) << i;
    most = std::max(most, report.sweeps);
  }
  EXPECT_LE(most, 60) << "more than some sweeps, four generalized steps and the proof";
}

TEST(Infeasible, BoxesBetweenWallsThatCloseAreNamedWhereTheyCannotLeave) {
  // Three in a row; only the middle one, and neither wall, is between others.
  std::vector<BodyModel> boxes;
  for (int i = -1; i < 2; ++i) boxes.push_back(box(kPressed, 0.5, {0.1 * i, 0.0, 0.05}));
  WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
  BodyModel wall = fixed_box({0.1, 0.5, 0.3}, {0.2, 0.0, 0.15});
  wall.kind = BodyKind::Kinematic;
  model.bodies = {fixed_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.05}), fixed_box({0.1, 0.5, 0.3}, {-0.2, 0.0, 0.15}), wall};
  model.bodies.insert(model.bodies.end(), boxes.begin(), boxes.end());
  model.finalize();
  Simulation run(model);
  for (int i = 1; i <= 10; ++i) {  // later they turn and slip past each other
    const KinematicTarget target{BodyId{2}, {Matrix3::Identity(), Vector3(0.2 - 1e-5 * i, 0.0, 0.15)}};
    WorldInput input;
    input.kinematic = {&target, 1};
    const StepReport report = run.step(input);
    ASSERT_TRUE(report.is_infeasible) << i;
    EXPECT_TRUE(report.residual_pair.a.is_valid());
    // Four contacts in a row share 10 mm/s: 2.5 each at best.
    EXPECT_GE(report.residual, 0.0024) << i;
    EXPECT_LE(report.residual, 0.0199) << i;
  }
}

TEST(Infeasible, IsNoStepThatHasASolution) {
  // A lid that turns while it comes down onto boxes that can slide away, and compliant boxes under a flat one.
  Rng rng = Rng(3).split("feasible");
  for (int scene = 0; scene < 20; ++scene) {
    SCOPED_TRACE(scene);
    const double side = rng.uniform(-0.05, 0.05);
    const WorldModel model = press_of({box(kPressed, 0.5, {side, 0.0, 0.05})}, scene % 2 == 0 ? 2e4 : 0.0);
    Simulation run(model);
    // Odd scenes: the lid goes with the box, upwards.
    const double way = scene % 2 == 0 ? -1e-5 : 1e-5;
    (void)lower_to(run, 0.1);
    for (int i = 1; i <= 100; ++i) {
      const StepReport report = lower_to(run, 0.1 + way * i);
      ASSERT_EQ(report.status, StepStatus::Converged) << i;
      ASSERT_FALSE(report.is_infeasible) << i;
    }
  }
}

TEST(Infeasible, EndsOnceTheLidLifts) {
  const WorldModel model = press_of({box(kPressed, 0.5, {0.0, 0.0, 0.05})});
  Simulation run(model);
  (void)lower_to(run, 0.1);
  for (int i = 1; i <= 100; ++i) (void)lower_to(run, 0.1 - 1e-5 * i);
  for (int i = 1; i <= 400; ++i) {
    const StepReport report = lower_to(run, 0.099 + 1e-5 * i);
    ASSERT_FALSE(report.is_infeasible) << i;
  }
  EXPECT_EQ(lower_to(run, 0.15).status, StepStatus::Converged);
  EXPECT_LT(run.body(2).velocity.norm(), 0.02);
  EXPECT_NEAR(run.body(2).p_WBcm.z(), 0.05, 1e-5);
}

}  // namespace
}  // namespace snug::physics::test
