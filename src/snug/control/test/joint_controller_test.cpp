// JointController: follows like the point model, keeps every limit, and holds where there is no way.
#include "snug/control/joint_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::control {
namespace {

using robot::JointVector;

Pose random_pose_near(Rng& rng, const Pose& X_WE, double distance, double angle) {
  const auto vector = [&](double size) {
    return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
  };
  return {exp_rotation(vector(angle)) * X_WE.R, X_WE.p + vector(distance)};
}

TEST(JointController, FollowsAsACriticallyDampedTaskFarFromAllLimits) {
  const JointController controller = test::make_controller();
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  const Pose X_WE = robot::forward_tool(controller.arm(), state.q);
  const ToolTarget target{{X_WE.R, X_WE.p + Vector3(0.02, -0.03, 0.01)}, false, {}};
  const double omega = std::sqrt(10.0);
  for (int i = 1; i <= 500; ++i) {
    const JointTick report = controller.tick(target, state, work);
    ASSERT_FALSE(report.is_holding);
    ASSERT_EQ(report.active_count, 0);
    const double t = 0.008 * i;
    const double left = (1.0 + omega * t) * std::exp(-omega * t);  // closed form
    const Vector3 expected = target.X_WE.p - left * Vector3(0.02, -0.03, 0.01);
    // One tick of 8 ms is 2.5 % of the task's time constant: first-order integration is off by a few per cent of that.
    EXPECT_LT((robot::forward_tool(controller.arm(), state.q).p - expected).norm(), 0.001);
  }
  EXPECT_LT((robot::forward_tool(controller.arm(), state.q).p - target.X_WE.p).norm(), 1e-5);
}

TEST(JointController, IsOnAnExactTargetAtTheEndOfTheTick) {
  const JointController controller = test::make_controller();
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  const Pose X_WE = robot::forward_tool(controller.arm(), state.q);
  for (int i = 1; i <= 250; ++i) {
    const double t = 0.008 * i;  // a soft start: 0.1 sin^2
    const double p = 0.1 * std::pow(std::sin(t), 2), v = 0.1 * std::sin(2.0 * t);
    const ToolTarget target{{X_WE.R, X_WE.p + p * Vector3::UnitX()}, true, {v * Vector3::UnitX(), Vector3::Zero()}};
    (void)controller.tick(target, state, work);
    // Constant acceleration over a tick against a smooth path: jerk 0.8 m/s^3 times (8 ms)^3, and curvature of the path
    // of the tool; 1 um is a hundred times that.
    EXPECT_LT((robot::forward_tool(controller.arm(), state.q).p - target.X_WE.p).norm(), 1e-6);
  }
}

TEST(JointController, KeepsEveryLimitWhereverItIsSent) {
  const JointController controller = test::make_controller(100.0);  // ten times the demonstrator's gain: pushes harder
  const model::RobotParams& params = controller.settings().params;
  const robot::ArmModel& arm = controller.arm();
  JointControllerWork work;
  Rng rng = Rng(11).split("limits");
  int limited = 0;
  for (int run = 0; run < 12; ++run) {
    SCOPED_TRACE(run);
    bool has_held = false;
    JointState state = controller.make_state(test::start_joints(controller));
    const Pose X_WE = robot::forward_tool(arm, state.q);
    for (int leg = 0; leg < 4; ++leg) {
      const ToolTarget target{random_pose_near(rng, X_WE, 1.5, 3.0), false, {}};
      for (int i = 0; i < 250; ++i) {
        const JointState before = state;
        const JointTick report = controller.tick(target, state, work);
        limited += report.active_count > 0 || report.is_holding ? 1 : 0;
        for (int j = 0; j < arm.joint_count(); ++j) {
          const robot::Joint& joint = arm.joints[static_cast<std::size_t>(j)];
          const double speed = params.velocity_fraction * joint.max_speed;
          EXPECT_LE(std::abs(state.qd[j]), speed + 1e-9);  // rounding of the solver
          EXPECT_LE(std::abs(state.qdd[j]), params.max_joint_acceleration + 1e-6);
          EXPECT_GT(state.q[j], joint.lower);
          EXPECT_LT(state.q[j], joint.upper);
          // never a jump: position and speed are those of a constant acceleration
          EXPECT_NEAR(state.q[j], before.q[j] + 0.008 * (before.qd[j] + state.qd[j]) / 2.0, 1e-12);
        }
        const robot::ArmPose at = robot::forward(arm, state.q);
        for (int pair = 0; pair < static_cast<int>(controller.clearance().pairs().size()); ++pair) {
          const Nearest nearest = controller.clearance().nearest(at, pair);
          if (nearest.index < 0) continue;
          // Linearised over a tick, and the nearest points wander: some millimetres are used up. Where braking for the
          // distance and for the other limits contradict, the arm brakes all joints: more of the safety distance is.
          has_held = has_held || report.is_holding;
          EXPECT_GT(nearest.distance,
                    controller.clearance().pairs()[static_cast<std::size_t>(pair)].safety - (has_held ? 0.03 : 0.005))
              << controller.clearance().name_of(pair);
        }
      }
    }
  }
  EXPECT_GT(limited, 1000);  // the targets really ask for too much
}

TEST(JointController, StaysOffAJointLimit) {
  model::RobotParams params = test::make_controller().settings().params;
  const JointController controller = test::make_controller(params);
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  const robot::Joint& wrist = controller.arm().joints[5];
  state.q[5] = wrist.upper - 0.3;
  const Pose X_WE = robot::forward_tool(controller.arm(), state.q);
  const ToolTarget target{{X_WE.R * exp_rotation(0.6 * Vector3::UnitZ()), X_WE.p}, false, {}};
  const ToolTarget other{{X_WE.R * exp_rotation(-0.6 * Vector3::UnitZ()), X_WE.p}, false, {}};
  for (const ToolTarget& toward : {target, other}) {  // one of the two runs into the limit
    JointState run = state;
    for (int i = 0; i < 3000; ++i) (void)controller.tick(toward, run, work);
    EXPECT_LT(run.q[5], wrist.upper - params.damper.safety * (wrist.upper - wrist.lower));
    EXPECT_LT(run.qd.norm(), 1e-3);
  }
}

TEST(JointController, BrakesWithoutAJumpAndNamesTheLimitWhenThereIsNoWay) {
  const JointController controller = test::make_controller();
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  state.qd[2] = 4.0;  // more than 1.57 rad/s allowed, and 15 rad/s^2 take away only 0.12 in a tick
  const ToolTarget target{robot::forward_tool(controller.arm(), state.q), false, {}};
  const JointTick report = controller.tick(target, state, work);
  ASSERT_TRUE(report.is_holding);
  EXPECT_EQ(report.worst.index, 2);
  // (4 - 1.57) / 0.008 = 304 rad/s^2 are needed, 15 allowed: each of the two rows misses half of the difference
  EXPECT_NEAR(report.violation, 0.5 * ((4.0 - 0.5 * controller.arm().joints[2].max_speed) / 0.008 - 15.0), 1e-6);
  EXPECT_NE(controller.describe(report.worst).find("elbow_joint"), std::string::npos);
  EXPECT_NEAR(state.qd[2], 4.0 - 15.0 * 0.008, 1e-12);
  int ticks = 1;
  for (; state.held_ticks > 0 && ticks < 1000; ++ticks) (void)controller.tick(target, state, work);
  EXPECT_LT(ticks, 30);  // 2.43 / 0.12 = 21 ticks until the speed is allowed again; then it goes on
  EXPECT_LT(std::abs(state.qd[2]), 1.6);
}

TEST(JointController, HoldsWhenTheTargetIsNotANumber) {
  const JointController controller = test::make_controller();
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  state.qd[0] = 0.5;
  ToolTarget target{robot::forward_tool(controller.arm(), state.q), false, {}};
  target.X_WE.p.x() = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(controller.tick(target, state, work).is_holding);
  EXPECT_TRUE(state.q.allFinite());
  EXPECT_NEAR(state.qd.norm(), 0.0, 1e-12);
}

TEST(JointController, GoesThroughASingularityWithinItsLimits) {
  const JointController controller = test::make_controller();
  JointState state = controller.make_state(test::start_joints(controller));
  JointControllerWork work;
  // Straight up out of reach: the elbow stretches, where the Jacobian loses its rank.
  const Pose X_WE = robot::forward_tool(controller.arm(), state.q);
  const ToolTarget target{{X_WE.R, X_WE.p + Vector3(0.0, -2.0, 0.0)}, false, {}};
  double smallest = 1.0;
  for (int i = 0; i < 1500; ++i) {
    const JointTick report = controller.tick(target, state, work);
    EXPECT_FALSE(report.is_holding);
    EXPECT_LE(state.qdd.lpNorm<Eigen::Infinity>(), 15.0 + 1e-6);
    const robot::ArmPose at = robot::forward(controller.arm(), state.q);
    smallest = std::min(smallest, robot::singularity_measure(robot::tool_jacobian(controller.arm(), at)));
  }
  EXPECT_LT(smallest, 0.05);
  EXPECT_LT(state.qd.norm(), 0.05);  // it comes to rest, stretched toward the target
}

TEST(JointController, RefusesPairsAndPosturesThatDoNotFitTheArm) {
  model::RobotParams params = test::make_controller().settings().params;
  params.self_collision.push_back({"forearm_lnk", "gripper", 0.1, 0.05});
  try {
    (void)test::make_controller(params);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(error.expected.find("forearm_link"), std::string::npos);
  }
  params = test::make_controller().settings().params;
  params.posture.pop_back();
  EXPECT_THROW((void)test::make_controller(params), InputError);
}

TEST(PoseSolver, FindsTheJointsOfNearbyPoses) {
  const JointController controller = test::make_controller();
  const JointVector q = test::start_joints(controller);
  const Pose X_WE = robot::forward_tool(controller.arm(), q);
  EXPECT_LT((X_WE.p - test::demonstrator().controller.X_WE_start.p).norm(), 1e-9);
  Rng rng = Rng(5).split("poses");
  for (int i = 0; i < 200; ++i) {
    JointVector wanted = q;
    for (double& value : wanted) value += rng.uniform(-0.3, 0.3);
    const Pose X_WE_wanted = robot::forward_tool(controller.arm(), wanted);
    const PoseSolution solution = solve_pose(controller.arm(), X_WE_wanted, q);
    ASSERT_TRUE(solution.is_reached());
    EXPECT_LT((robot::forward_tool(controller.arm(), solution.q).p - X_WE_wanted.p).norm(), 1e-8);
  }
}

TEST(PoseSolver, EndsAsNearAsItComesWhenThePoseIsOutOfReach) {
  const JointController controller = test::make_controller();
  const JointVector q = test::start_joints(controller);
  const Pose X_WE = robot::forward_tool(controller.arm(), q);
  const PoseSolution solution = solve_pose(controller.arm(), {X_WE.R, X_WE.p + Vector3(0.0, -3.0, 0.0)}, q);
  EXPECT_FALSE(solution.is_reached());
  EXPECT_GT(solution.position_error, 1.0);
  EXPECT_TRUE(solution.q.allFinite());
}

}  // namespace
}  // namespace snug::control
