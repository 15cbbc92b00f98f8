// PacedSegment: straight line and fixed-axis turn that start and end at rest, as fast as tool, held box and joints
// allow.
#include "snug/motion/paced_segment.hpp"

#include <algorithm>
#include <limits>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

constexpr double kNoMotion = 1e-9;  ///< m or rad: rounding of poses, not a motion

}  // namespace

PacedSegment::PacedSegment(const Pose& X_WA, const Pose& X_WB, const Pace& pace, const PathLimits* others)
    : X_WA_(X_WA), X_WB_(X_WB) {
  SNUG_CHECK(X_WA.p.allFinite() && X_WA.R.allFinite() && X_WB.p.allFinite() && X_WB.R.allFinite(),
             "poses of a motion must be finite");
  line_W_ = X_WB.p - X_WA.p;
  turn_W_ = X_WA.R * log_rotation(X_WA.R.transpose() * X_WB.R);
  const double length = line_W_.norm(), angle = turn_W_.norm();
  if (length < kNoMotion) line_W_.setZero();
  if (angle < kNoMotion) turn_W_.setZero();
  if (length < kNoMotion && angle < kNoMotion) return;
  constexpr double kFree = std::numeric_limits<double>::infinity();
  const auto per = [&](double limit, double whole) { return whole < kNoMotion ? kFree : limit / whole; };
  std::array<double, kPathParts> rates{}, accelerations{};
  rates.fill(std::min(per(pace.max_speed, length), per(pace.max_turn_speed, angle)));
  accelerations.fill(std::min(per(pace.max_acceleration, length), per(pace.max_turn_acceleration, angle)));
  if (others != nullptr) others->limit(X_WA, X_WB, rates, accelerations);
  profile_ = PathProfile(rates, accelerations, pace.window);
}

PacedSegment::Increment PacedSegment::increment(double t) const noexcept {
  const PathProfile::Sample at = profile_.sample(t);
  return {exp_rotation(at.share * turn_W_), at.share * line_W_, {at.rate * line_W_, at.rate * turn_W_}};
}

ToolState PacedSegment::sample(double t) const noexcept {
  if (t >= duration()) return {X_WB_, {}};
  const Increment at = increment(t);
  return {{at.R_W * X_WA_.R, X_WA_.p + at.shift_W}, at.V_W};
}

Vector3 PacedSegment::direction_W() const noexcept {
  const double length = line_W_.norm();
  return length > 0.0 ? Vector3(line_W_ / length) : Vector3(Vector3::Zero());
}

}  // namespace snug::motion
