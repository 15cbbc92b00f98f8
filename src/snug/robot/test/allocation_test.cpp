// Kinematics, dynamics and the closed-form inverse never allocate: global new is counted.
#include <gtest/gtest.h>

#include <cmath>

#include "shipped_arm.hpp"
#include "snug/core/test/allocation_count.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/inverse.hpp"

namespace snug::robot {
namespace {

TEST(Robot, NeverAllocatesOnceAnArmIsLoaded) {
  const ArmModel& arm = test::shipped_arm();
  const InverseKinematics inverse(arm);
  Rng rng = Rng(30).split("allocation");
  const SpatialInertia load = distal_inertia(arm, find_link(arm, "ft_sensor"));
  const int sensor = find_link(arm, "ft_sensor");
  double sum = 0.0;
  const long before = snug::test::allocation_count();
  for (int k = 0; k < 100; ++k) {
    const JointVector q = test::random_joints(rng, 6, 3.0);
    const ArmPose at = forward(arm, q);
    const Jacobian J = tool_jacobian(arm, at);
    const ArmMotion motion{q, q, q};
    sum += singularity_measure(J) + mass_matrix(arm, q)(0, 0) + tool_bias_acceleration(arm, at, q)(0);
    sum += inverse_dynamics(arm, motion, Wrench{}, Vector3::UnitZ())(0);
    sum += sensor_wrench(arm, motion, sensor, load, Wrench{}, Vector3::UnitZ()).force.x();
    const auto found = inverse.nearest(at.X_WE, q);
    sum += found ? (*found)(0) : 0.0;
  }
  EXPECT_EQ(snug::test::allocation_count(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace snug::robot
