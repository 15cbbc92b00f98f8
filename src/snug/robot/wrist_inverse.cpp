// The inverse of an arm with a spherical wrist in closed form, from the lines of its axes.
#include "snug/robot/wrist_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "snug/robot/internal/lines.hpp"

namespace snug::robot {
namespace {

using internal::about;
using internal::kSingularSine;
using internal::Line;
using internal::wrapped;

/// The angle about `axis` that turns `from` to `to`, of what is square to it.
double turn_between(const Vector3& axis, const Vector3& from, const Vector3& to) noexcept {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
}

Vector3 square_to(const Vector3& axis, const Vector3& v) noexcept { return v - axis * axis.dot(v); }

/// Angles at which a turn of `v` about `axis` has the component `along` in `direction`; `beyond`: what is missing to
/// that (> 0), or left (< 0).
struct TurnPair {
  std::array<double, 2> angle{};
  double beyond = 0.0;
};
TurnPair turns_to(const Vector3& axis, const Vector3& v, const Vector3& direction, double along) noexcept {
  const double cosine = direction.dot(square_to(axis, v)), sine = direction.dot(axis.cross(v));
  const double size = std::hypot(cosine, sine), rest = along - direction.dot(axis) * axis.dot(v);
  const double middle = std::atan2(sine, cosine);
  const double half = size > 0.0 ? std::acos(std::clamp(rest / size, -1.0, 1.0)) : 0.0;
  return {{middle + half, middle - half}, std::abs(rest) - size};
}

/// The joints of the wrist that turn as R says: Rot(q4) Rot(q5) Rot(q6) = R.
void add_wrists(const WristGeometry& arm, const std::array<double, 3>& first, const Matrix3& R, double free_q6,
                ClosedBranches& found) noexcept {
  const Vector3 &a4 = arm.axis[3], &a5 = arm.axis[4], &a6 = arm.axis[5];
  const Vector3 turned = R * a6;
  // The angles at which a6 stands to a4 as it has to; by the sine too, which keeps the digits of small angles.
  const TurnPair bends = turns_to(a5, a6, a4, a4.dot(turned));
  for (const double q5 : bends.angle) {
    const Vector3 bent = about(a5, q5) * a6;
    double q4 = 0.0, q6 = free_q6;
    if (square_to(a4, turned).norm() > kSingularSine && square_to(a4, bent).norm() > kSingularSine) {
      q4 = turn_between(a4, bent, turned);
      q6 = turn_between(a6, R.transpose() * a4, about(a5, -q5) * a4);
    } else {  // a4 and a6 in one line: only the sum of both turns is known
      const Matrix3 rest = R * (about(a5, q5) * about(a6, free_q6)).transpose();
      const Vector3 any = a4.unitOrthogonal();
      q4 = turn_between(a4, any, rest * any);
    }
    std::array<double, 6>& q = found.q[static_cast<std::size_t>(found.count++)];
    q = {first[0], first[1], first[2], q4, q5, q6};
    for (double& value : q) value = wrapped(value);
  }
}

/// m, of the shortest side of the arm, below which it cannot be bent.
bool is_long_enough(const WristGeometry& g) {
  return square_to(g.axis[1], g.point[2] - g.point[1]).norm() > internal::kSmallestLink &&
         square_to(g.axis[1], g.wrist - g.point[2]).norm() > internal::kSmallestLink;
}

}  // namespace

std::optional<WristGeometry> find_wrist_geometry(const ArmModel& arm) {
  const std::optional<internal::SixAxes> axes = internal::six_axes(arm);
  if (!axes) return std::nullopt;
  const auto& [axis, X_BE] = *axes;
  if (!internal::are_square(axis[0], axis[1]) || !internal::are_parallel(axis[1], axis[2])) return std::nullopt;
  if (internal::are_parallel(axis[3], axis[4]) || internal::are_parallel(axis[4], axis[5])) return std::nullopt;
  const Vector3 before = internal::nearest_point(axis[4], axis[3]), after = internal::nearest_point(axis[4], axis[5]);
  const bool is_spherical = internal::distance(axis[3], axis[4]) < internal::kLargestShift &&
                            internal::distance(axis[4], axis[5]) < internal::kLargestShift &&
                            (after - before).norm() < internal::kLargestShift;
  if (!is_spherical) return std::nullopt;

  WristGeometry g;
  for (std::size_t i = 0; i < 6; ++i) g.axis[i] = axis[i].direction;
  g.axis[1] = square_to(g.axis[0], g.axis[1]).normalized();
  g.axis[2] = g.axis[1] * (g.axis[1].dot(g.axis[2]) > 0.0 ? 1.0 : -1.0);
  for (std::size_t i = 0; i < 3; ++i) g.point[i] = axis[i].point;
  g.wrist = 0.5 * (before + after);
  g.R_BE = X_BE.R;
  g.p_EC_E = X_BE.R.transpose() * (g.wrist - X_BE.p);
  if (!is_long_enough(g)) return std::nullopt;
  return g;
}

ClosedBranches solve_wrist_arm(const WristGeometry& arm, const Pose& X_BE, double q6, double slack) noexcept {
  ClosedBranches found;
  const Vector3 wrist = X_BE * arm.p_EC_E;
  const Matrix3 R = X_BE.R * arm.R_BE.transpose();  // of all six turns
  const Vector3 &a1 = arm.axis[0], &a2 = arm.axis[1], &a3 = arm.axis[2];
  // Turned back about the first axis, the wrist is as far along the second as the other joints leave it.
  const TurnPair pans = turns_to(a1, wrist - arm.point[0], a2, a2.dot(arm.wrist - arm.point[0]));
  if (pans.beyond > slack) {
    found.shortfall = pans.beyond;
    return found;
  }
  found.shortfall = 1e3;  // m; every branch lowers it
  const Vector3 upper_arm = square_to(a2, arm.point[2] - arm.point[1]),
                forearm = square_to(a2, arm.wrist - arm.point[2]);
  const double l1 = upper_arm.norm(), l2 = forearm.norm();
  for (const double minus_q1 : pans.angle) {
    const Vector3 reach = square_to(a2, arm.point[0] + about(a1, minus_q1) * (wrist - arm.point[0]) - arm.point[1]);
    const double r = reach.norm();
    const double beyond = std::max(r - (l1 + l2), std::abs(l1 - l2) - r);
    found.shortfall = std::min(found.shortfall, beyond);
    if (beyond > slack) continue;
    const double elbow = std::acos(std::clamp((r * r - l1 * l1 - l2 * l2) / (2.0 * l1 * l2), -1.0, 1.0));
    const double straight = turn_between(a2, forearm, upper_arm);  // about a2, from q3 = 0 to a stretched arm
    for (const double bend : {elbow, -elbow}) {
      const double q3 = (straight + bend) * a2.dot(a3);
      const double q2 = turn_between(a2, upper_arm + about(a2, straight + bend) * forearm, reach);
      const Matrix3 R_first = about(a1, -minus_q1) * about(a2, q2) * about(a3, q3);
      add_wrists(arm, {-minus_q1, q2, q3}, R_first.transpose() * R, q6, found);
    }
  }
  return found;
}

}  // namespace snug::robot
