// Lines: axes of joints as lines in space, and angles as the inverses of arms count them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "snug/robot/kinematics.hpp"

namespace snug::robot::internal {

/// How far an arm may be from the ideal one, for Newton steps to arrive from its branches.
inline constexpr double kLargestTilt = 3.0 * std::numbers::pi / 180.0;  // rad
inline constexpr double kLargestShift = 0.020;                          // m
inline constexpr double kSmallestLink = 0.02;                           // m
/// Below this the sine of the fifth joint is rounding, and the wrist singular.
inline constexpr double kSingularSine = 1e-9;

/// The line of a joint's axis.
struct Line {
  Vector3 point;
  Vector3 direction;
};

/// Point of line a that is nearest to line b (not parallel).
inline Vector3 nearest_point(const Line& a, const Line& b) {
  const Vector3 r = b.point - a.point;
  const double along = a.direction.dot(b.direction);
  const double t = (a.direction.dot(r) - along * b.direction.dot(r)) / (1.0 - along * along);
  return a.point + t * a.direction;
}

inline double distance(const Line& a, const Line& b) { return (nearest_point(a, b) - nearest_point(b, a)).norm(); }

inline bool are_square(const Line& a, const Line& b) {
  return std::abs(a.direction.dot(b.direction)) < std::sin(kLargestTilt);
}

inline bool are_parallel(const Line& a, const Line& b) {
  return a.direction.cross(b.direction).norm() < std::sin(kLargestTilt);
}

/// Of an arm of six joints that turn.
struct SixAxes {
  std::array<Line, 6> axis;  ///< at q = 0, in the root link
  Pose X_BE;                 ///< at q = 0
};
/// Nothing for another arm.
inline std::optional<SixAxes> six_axes(const ArmModel& arm) {
  const auto is_turning = [](const Joint& joint) { return joint.kind == JointKind::Revolute; };
  if (arm.joint_count() != 6 || !arm.followers.empty() || !std::ranges::all_of(arm.joints, is_turning))
    return std::nullopt;
  ArmModel at_root = arm;
  at_root.X_WB = Pose{};
  const ArmPose at = forward(at_root, JointVector::Zero(6));
  SixAxes axes{{}, at.X_WE};
  for (std::size_t i = 0; i < 6; ++i) axes.axis[i] = {at.X_WS[i + 1].p, at.axis_W[i]};
  return axes;
}

inline Matrix3 about(const Vector3& axis, double angle) noexcept {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// In (-pi, pi].
inline double wrapped(double angle) noexcept {
  const double turn = 2.0 * std::numbers::pi;
  const double rest = angle - turn * std::round(angle / turn);
  return rest <= -std::numbers::pi ? rest + turn : rest;
}

}  // namespace snug::robot::internal
