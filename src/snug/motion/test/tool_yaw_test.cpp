// Tool yaw: that of a tool that points down, whatever little it is tilted.
#include "snug/motion/tool_yaw.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace snug::motion {
namespace {

using std::numbers::pi;

Matrix3 pointing_down(double yaw, double tilt = 0.0) {
  return exp_rotation(Vector3(tilt, 0.0, 0.0)) * exp_rotation(Vector3(0.0, 0.0, yaw)) *
         exp_rotation(Vector3(0.0, pi, 0.0));
}

TEST(YawOf, IsThatOfAToolThatPointsDownAndNothingElse) {
  for (double yaw = -3.1; yaw < 3.1; yaw += 0.1) {
    ASSERT_TRUE(yaw_of(pointing_down(yaw)));
    EXPECT_NEAR(*yaw_of(pointing_down(yaw)), yaw, 1e-12);
    EXPECT_TRUE(upright_tool(yaw).isApprox(pointing_down(yaw), 1e-12));
    EXPECT_NEAR(*yaw_of(pointing_down(yaw, 0.2)), yaw, 0.011) << "tilted a little";  // up to (1 - cos 0.2) / 2
  }
  EXPECT_FALSE(yaw_of(pointing_down(0.3, 0.5 * pi)));
  EXPECT_FALSE(yaw_of(Matrix3::Identity()));
}

}  // namespace
}  // namespace snug::motion
