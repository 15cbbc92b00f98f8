// The inverse of a UR-like arm in closed form, from the lines of its axes (docs/theory/robot.md).
#include "snug/robot/ur_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/robot/internal/lines.hpp"

namespace snug::robot {
namespace {

using internal::about;
using internal::are_parallel;
using internal::are_square;
using internal::distance;
using internal::kLargestShift;
using internal::kSingularSine;
using internal::kSmallestLink;
using internal::Line;
using internal::nearest_point;
using internal::wrapped;

double plane_angle(const Vector3& v) noexcept { return std::atan2(v.z(), v.x()); }

/// What stays the same for both elbows: the arm up to the wrist, for one shoulder and one wrist branch.
struct WristBranch {
  double q1 = 0.0;
  double q5 = 0.0;
  double q6 = 0.0;
  double turn = 0.0;     ///< rad, plane angle by which joints 2 to 4 turn together
  double reach_x = 0.0;  ///< m, axis 4 in the plane, from axis 2
  double reach_z = 0.0;
};

WristBranch solve_wrist(const UrGeometry& arm, const Matrix3& R_1E, const Vector3& p_1, double angle, double free_q6) {
  const Vector3 u = -Vector3::UnitY();
  WristBranch b;
  b.q5 = angle - arm.angle_z6;
  const Matrix3 R_56 = about(arm.z5, b.q5);
  // Turns of joints 2-4 and 6 together: R_1E R_0E^T = Rot(u, turn) Rot(z5, q5) Rot(z6, q6).
  const Matrix3 turned = R_1E * arm.R_0E.transpose();
  const double sine = std::sin(angle);
  if (std::abs(sine) > kSingularSine) {
    const Vector3 v = (turned * arm.z6 - std::cos(angle) * u) / sine;
    b.turn = plane_angle(u.cross(v)) - plane_angle(arm.z5);
  } else {
    const Matrix3 rest = turned * (R_56 * about(arm.z6, free_q6)).transpose();
    b.turn = plane_angle(rest * arm.z5) - plane_angle(arm.z5);
  }
  const Matrix3 R_turn = about(u, b.turn);
  const Vector3 side = (R_turn * R_56).transpose() * (turned * arm.z5);
  b.q6 = std::atan2(arm.z6.dot(arm.z5.cross(side)), arm.z5.dot(side));
  const Vector3 reach = p_1 - arm.wrist * (R_turn * arm.z5);
  b.reach_x = reach.x();
  b.reach_z = reach.z();
  return b;
}

void add_elbows(const UrGeometry& arm, const WristBranch& b, double slack, ClosedBranches& found) {
  const double l1 = arm.upper_arm;
  const double l2 = arm.forearm;
  const double r = std::hypot(b.reach_x, b.reach_z);
  const double beyond = std::max(r - (l1 + l2), std::abs(l1 - l2) - r);
  found.shortfall = std::min(found.shortfall, beyond);
  if (beyond > slack) return;
  const double cosine = (r * r - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
  const double elbow = std::acos(std::clamp(cosine, -1.0, 1.0));
  for (const double bend : {elbow, -elbow}) {
    const double upper = std::atan2(b.reach_z, b.reach_x) - std::atan2(l2 * std::sin(bend), l1 + l2 * std::cos(bend));
    const double q2 = upper - arm.angle_upper_arm;
    const double q23 = upper + bend - arm.angle_forearm;
    std::array<double, 6>& q = found.q[static_cast<std::size_t>(found.count++)];
    q = {b.q1, arm.sign[1] * q2, arm.sign[2] * (q23 - q2), arm.sign[3] * (b.turn - q23), b.q5, b.q6};
    for (double& value : q) value = wrapped(value);
  }
}

}  // namespace

std::optional<UrGeometry> find_ur_geometry(const ArmModel& arm) {
  const std::optional<internal::SixAxes> axes = internal::six_axes(arm);
  if (!axes) return std::nullopt;
  const auto& [axis, X_BE] = *axes;
  const bool is_ur = are_square(axis[0], axis[1]) && are_parallel(axis[1], axis[2]) && are_parallel(axis[2], axis[3]) &&
                     are_parallel(axis[1], axis[3]) && are_square(axis[3], axis[4]) && are_square(axis[4], axis[5]);
  if (!is_ur) return std::nullopt;
  for (const auto& [a, b] : {std::pair{0, 1}, {3, 4}, {4, 5}})
    if (distance(axis[static_cast<std::size_t>(a)], axis[static_cast<std::size_t>(b)]) > kLargestShift)
      return std::nullopt;

  UrGeometry g;
  const Vector3 z = axis[0].direction;
  const Vector3 u = (axis[1].direction - z * z.dot(axis[1].direction)).normalized();
  g.X_B0.R << z.cross(u), -u, z;
  g.X_B0.p = nearest_point(axis[0], axis[1]);
  const Pose X_0B = g.X_B0.inverse();
  const auto in_0 = [&](const Vector3& p_B) -> Vector3 { return X_0B * p_B; };
  g.sign.fill(1.0);
  for (const std::size_t i : {1u, 2u, 3u}) g.sign[i] = axis[i].direction.dot(u) > 0.0 ? 1.0 : -1.0;
  const Vector3 p_0elbow = in_0(axis[2].point);
  const Vector3 p_0wrist = in_0(nearest_point(axis[3], axis[4]));
  const Vector3 p_0end = in_0(nearest_point(axis[4], axis[5]));
  g.upper_arm = std::hypot(p_0elbow.x(), p_0elbow.z());
  const Vector3 forearm = p_0wrist - p_0elbow;
  g.forearm = std::hypot(forearm.x(), forearm.z());
  if (g.upper_arm < kSmallestLink || g.forearm < kSmallestLink) return std::nullopt;
  g.angle_upper_arm = plane_angle(p_0elbow);
  g.angle_forearm = plane_angle(forearm);
  g.offset = -p_0wrist.y();
  const Vector3 u_0 = -Vector3::UnitY();
  const Vector3 z5 = X_0B.R * axis[4].direction;
  g.z5 = (z5 - u_0 * u_0.dot(z5)).normalized();
  g.wrist = g.z5.dot(p_0end - p_0wrist);
  const Vector3 z6 = X_0B.R * axis[5].direction;
  g.z6 = (z6 - g.z5 * g.z5.dot(z6)).normalized();
  g.angle_z6 = std::atan2(g.z6.dot(g.z5.cross(u_0)), g.z6.dot(u_0));
  g.R_0E = X_0B.R * X_BE.R;
  g.p_E6_E = g.R_0E.transpose() * (p_0end - in_0(X_BE.p));
  return g;
}

ClosedBranches solve_ur(const UrGeometry& arm, const Pose& X_BE, double q6, double slack) noexcept {
  ClosedBranches found;
  const Pose X_0E = arm.X_B0.inverse() * X_BE;
  const Vector3 p_06 = X_0E * arm.p_E6_E;
  // The wrist lies `offset` off the plane of the arm: p_x sin q1 - p_y cos q1 = offset.
  const double from_axis = std::hypot(p_06.x(), p_06.y());
  const double too_near = std::abs(arm.offset) - from_axis;
  if (too_near > slack) {
    found.shortfall = too_near;
    return found;
  }
  found.shortfall = 1e3;  // m; every branch lowers it
  const double direction = std::atan2(p_06.y(), p_06.x());
  const double lean = from_axis > 0.0 ? std::asin(std::clamp(arm.offset / from_axis, -1.0, 1.0)) : 0.0;
  for (const double q1 : {direction + lean, direction + std::numbers::pi - lean}) {
    const Matrix3 R_10 = about(Vector3::UnitZ(), -q1);
    const Matrix3 R_1E = R_10 * X_0E.R;
    const Vector3 p_1 = R_10 * p_06;
    const double cosine = -(R_1E * (arm.R_0E.transpose() * arm.z6)).y();
    // atan2 keeps the digits that acos loses near a singular wrist.
    const Vector3 z6 = R_1E * (arm.R_0E.transpose() * arm.z6);
    const double angle = std::atan2(std::hypot(z6.x(), z6.z()), cosine);
    for (const double a : {angle, -angle}) {
      WristBranch wrist = solve_wrist(arm, R_1E, p_1, a, q6);
      wrist.q1 = q1;
      add_elbows(arm, wrist, slack, found);
    }
  }
  return found;
}

}  // namespace snug::robot
