// Kinematics and dynamics of the shipped arm against closed forms and finite differences.
#include <gtest/gtest.h>

#include <numbers>

#include "shipped_arm.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::robot {
namespace {

using test::random_joints;
using test::shipped_arm;

TEST(Kinematics, GivesTheHomeOrientationAtTheDemonstratorsStance) {
  JointVector q(6);
  q << std::numbers::pi, -std::numbers::pi / 2, -std::numbers::pi / 2, -std::numbers::pi / 2, std::numbers::pi / 2,
      std::numbers::pi / 2;
  const Pose X_WE = forward_tool(shipped_arm(), q);
  EXPECT_LT((X_WE.R - Vector3(-1, 1, -1).asDiagonal().toDenseMatrix()).norm(), 1e-12);
}

TEST(Kinematics, HasTheJacobianThatDifferencesGive) {
  Rng rng = Rng(3).split("jacobian");
  const ArmModel& arm = shipped_arm();
  for (int k = 0; k < 50; ++k) {
    const JointVector q = random_joints(rng, 6, 3.0);
    const ArmPose at = forward(arm, q);
    const Jacobian J = tool_jacobian(arm, at);
    EXPECT_LT((at.X_WE.p - forward_tool(arm, q).p).norm(), 1e-15);
    for (int i = 0; i < 6; ++i) {
      constexpr double h = 1e-6;  // central difference: error about h^2 + 1e-16 / h = 1e-10
      JointVector plus = q, minus = q;
      plus(i) += h;
      minus(i) -= h;
      const Pose a = forward_tool(arm, minus), b = forward_tool(arm, plus);
      EXPECT_LT(((b.p - a.p) / (2 * h) - J.block<3, 1>(0, i)).norm(), 1e-8);
      EXPECT_LT((log_rotation(b.R * a.R.transpose()) / (2 * h) - J.block<3, 1>(3, i)).norm(), 1e-8);
    }
  }
}

TEST(Dynamics, HoldsAnExternalWrenchByTheTransposedJacobian) {
  Rng rng = Rng(4).split("wrench");
  const ArmModel& arm = shipped_arm();
  const JointVector zero = JointVector::Zero(6);
  for (int k = 0; k < 20; ++k) {
    const JointVector q = random_joints(rng, 6, 3.0);
    const Wrench F{Vector3(rng.normal(), rng.normal(), rng.normal()),
                   Vector3(rng.normal(), rng.normal(), rng.normal())};
    const JointVector tau = inverse_dynamics(arm, {q, zero, zero}, F, Vector3::Zero());
    const JointVector expected = -(tool_jacobian(arm, forward(arm, q)).transpose() * as_vector(F));
    EXPECT_LT((tau - expected).norm(), 1e-12);
  }
}

TEST(Sensor, ReadsTheWeightOfItsLoadAtRest) {
  const ArmModel& arm = shipped_arm();
  const int sensor = find_link(arm, "ft_sensor");
  ASSERT_GE(sensor, 0);
  const SpatialInertia load = distal_inertia(arm, sensor);
  EXPECT_NEAR(load.mass, 1.0, 1e-12);  // rod 0.9 kg and cup 0.1 kg
  JointVector q(6);
  q << std::numbers::pi, -std::numbers::pi / 2, -std::numbers::pi / 2, -std::numbers::pi / 2, std::numbers::pi / 2, 0.3;
  const JointVector zero = JointVector::Zero(6);
  const Wrench F = sensor_wrench(arm, {q, zero, zero}, sensor, load, Wrench{}, Vector3(0, 0, -9.81));
  EXPECT_NEAR(F.force.z(), 9.81, 1e-9);  // the tool points down: the weight pulls along +z
  EXPECT_NEAR(F.force.head<2>().norm(), 0.0, 1e-9);
  EXPECT_NEAR(F.torque.norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace snug::robot
