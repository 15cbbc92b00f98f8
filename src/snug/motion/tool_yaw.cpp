// Tool yaw: how a tool that points down is turned about the vertical.
#include "snug/motion/tool_yaw.hpp"

#include <cmath>
#include <numbers>

namespace snug::motion {
namespace {

constexpr double kSteepest = 0.866;  ///< cosine of 30 degrees

}  // namespace

std::optional<double> yaw_of(const Matrix3& R_WE) {
  if (R_WE(2, 2) > -kSteepest) return std::nullopt;
  return std::atan2(-R_WE(1, 0) - R_WE(0, 1), R_WE(1, 1) - R_WE(0, 0));
}

Matrix3 upright_tool(double yaw) {
  return exp_rotation(Vector3(0.0, 0.0, yaw)) * exp_rotation(Vector3(0.0, std::numbers::pi, 0.0));
}

}  // namespace snug::motion
