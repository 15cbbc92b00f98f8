// Way: where the tool passes from one pose to another: straight, or around the robot's first axis, which then turns
// evenly.
#include "snug/motion/way.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

constexpr double kNoMotion = 1e-9;  ///< m or rad: rounding of poses, not a motion

Matrix3 about_vertical(double angle) { return exp_rotation(Vector3(0.0, 0.0, angle)); }

}  // namespace

Way::Way(const Pose& X_WA, const Pose& X_WB, const std::optional<PanAxis>& pan_axis)
    : X_WA_(X_WA), X_WB_(X_WB), line_W_(X_WB.p - X_WA.p) {
  SNUG_CHECK(X_WA.p.allFinite() && X_WA.R.allFinite() && X_WB.p.allFinite() && X_WB.R.allFinite(),
             "poses of a motion must be finite");
  if (line_W_.norm() < kNoMotion) line_W_.setZero();
  if (pan_axis) {
    const Vector3 from = X_WA.p - pan_axis->p_WB, to = X_WB.p - pan_axis->p_WB;
    const double radius = from.head<2>().norm(), radius_end = to.head<2>().norm();
    const double pan = pan_between(pan_axis->p_WB, X_WA.p, X_WB.p);
    if (std::min(radius, radius_end) >= pan_axis->least_radius && std::abs(pan) >= pan_axis->least_pan) {
      pan_ = pan;
      p_WB_ = pan_axis->p_WB;
      radius_ = radius;
      radius_gain_ = radius_end - radius;
      azimuth_ = std::atan2(from.y(), from.x());
    }
  }
  turn_W_ = X_WA.R * log_rotation(X_WA.R.transpose() * about_vertical(-pan_) * X_WB.R);
  if (turn_W_.norm() < kNoMotion) turn_W_.setZero();
}

Vector3 Way::shift(double share) const noexcept {
  if (is_straight()) return share * line_W_;
  const double radius = radius_ + share * radius_gain_, angle = azimuth_ + share * pan_;
  return {p_WB_.x() + radius * std::cos(angle) - X_WA_.p.x(), p_WB_.y() + radius * std::sin(angle) - X_WA_.p.y(),
          share * line_W_.z()};
}

Pose Way::increment(double share) const noexcept {
  const Matrix3 R = exp_rotation(share * turn_W_);
  return {is_straight() ? R : Matrix3(about_vertical(share * pan_) * R), shift(share)};
}

Pose Way::at(double share) const noexcept {
  const Pose by = increment(share);
  return {by.R * X_WA_.R, X_WA_.p + by.p};
}

Way::Slope Way::slope(double share) const noexcept {
  Slope slope;
  if (is_straight()) {
    slope.first = {line_W_, turn_W_};
    return slope;
  }
  const double radius = radius_ + share * radius_gain_, angle = azimuth_ + share * pan_;
  const Vector3 outward(std::cos(angle), std::sin(angle), 0.0), along(-std::sin(angle), std::cos(angle), 0.0);
  const Vector3 turn = about_vertical(share * pan_) * turn_W_, pan(0.0, 0.0, pan_);
  slope.first = {radius_gain_ * outward + radius * pan_ * along + Vector3(0.0, 0.0, line_W_.z()), pan + turn};
  slope.second = {2.0 * radius_gain_ * pan_ * along - radius * pan_ * pan_ * outward, pan.cross(turn)};
  return slope;
}

bool Way::is_motion() const noexcept { return !line_W_.isZero() || !turn_W_.isZero(); }

double pan_between(const Vector3& p_WB, const Vector3& p_W_from, const Vector3& p_W_to) {
  const Vector3 from = p_W_from - p_WB, to = p_W_to - p_WB;
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.head<2>().dot(to.head<2>()));
}

}  // namespace snug::motion
