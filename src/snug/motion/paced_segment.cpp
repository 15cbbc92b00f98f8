// PacedSegment: a motion along a way, from rest to rest, as fast as tool, held box and joints allow.
#include "snug/motion/paced_segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace snug::motion {
namespace {

/// On a bent way: of the largest acceleration, what may speed up, and what may bend. Together no more than all of it.
constexpr double kOfSpeedingUp = 0.7, kOfBending = 0.3;

/// What the tool's own limits leave at one point of the way.
struct Most {
  double rate = 0.0;          ///< 1/s
  double acceleration = 0.0;  ///< 1/s^2
};

Most most_at(const Way& way, const Pace& pace, double share) {
  constexpr double kFree = std::numeric_limits<double>::infinity();
  const auto per = [](double limit, const Vector3& whole) { return whole.isZero() ? kFree : limit / whole.norm(); };
  const auto [first, second] = way.slope(share);
  Most most{std::min(per(pace.max_speed, first.linear), per(pace.max_turn_speed, first.angular)),
            std::min(per(pace.max_acceleration, first.linear), per(pace.max_turn_acceleration, first.angular))};
  if (way.is_straight()) return most;
  most.acceleration *= kOfSpeedingUp;
  const double bend =
      kOfBending * std::min(per(pace.max_acceleration, second.linear), per(pace.max_turn_acceleration, second.angular));
  most.rate = std::min(most.rate, std::sqrt(bend));
  return most;
}

using Parts = std::array<double, kPathParts>;

/// Where half of the motion comes so much later that both halves do not speed up at once, so much goes into the first
/// half of the way. Slowing down there may end in contact.
constexpr double kBeforeShaper = 2.0;

/// So slow that more than the limits may go into the average.
PathProfile slow_profile(Parts rates, Parts accelerations, const Smoothing& smoothing, double before_average) {
  for (std::size_t i = 0; i < kPathParts; ++i) {
    rates[i] = std::min(rates[i], accelerations[i] * smoothing.window);
    accelerations[i] *= before_average;
  }
  return {rates, accelerations, smoothing};
}

/// As fast as the limits allow.
PathProfile fast_profile(const Parts& rates, Parts accelerations, const Smoothing& smoothing) {
  bool is_apart = smoothing.shaper_delay > 0.0;
  for (std::size_t i = 0; i < kPathParts; ++i) {
    is_apart = is_apart && rates[i] / (kBeforeShaper * accelerations[i]) + smoothing.window <= smoothing.shaper_delay;
  }
  if (is_apart) {
    for (double& one : std::span(accelerations).first(kPathParts / 2)) one *= kBeforeShaper;
  }
  return {rates, accelerations, smoothing};
}

}  // namespace

PacedSegment::PacedSegment(const Way& way, const Pace& pace, const PathLimits* others) : way_(way) {
  if (!way.is_motion()) return;
  Parts rates{}, accelerations{};
  Most before = most_at(way, pace, 0.0);
  for (std::size_t i = 0; i < kPathParts; ++i) {
    const Most after = most_at(way, pace, static_cast<double>(i + 1) / kPathParts);
    rates[i] = std::min(before.rate, after.rate);
    accelerations[i] = std::min(before.acceleration, after.acceleration);
    before = after;
  }
  if (others != nullptr) others->limit(way, rates, accelerations);
  const Smoothing smoothing{pace.window, pace.shaper_delay};
  profile_ = fast_profile(rates, accelerations, smoothing);
  if (pace.before_average <= 1.0) return;
  const PathProfile slow = slow_profile(rates, accelerations, smoothing, pace.before_average);
  if (slow.duration() <= profile_.duration()) profile_ = slow;
}

PacedSegment::Increment PacedSegment::increment(double t) const noexcept {
  const PathProfile::Sample at = profile_.sample(t);
  const Pose by = way_.increment(at.share);
  const Twist slope = way_.slope(at.share).first;
  return {by.R, by.p, {at.rate * slope.linear, at.rate * slope.angular}};
}

ToolState PacedSegment::sample(double t) const noexcept {
  if (t >= duration()) return {way_.end(), {}};
  const Increment at = increment(t);
  return {{at.R_W * start().R, start().p + at.shift_W}, at.V_W};
}

Vector3 PacedSegment::direction_W() const noexcept {
  const Vector3 line = end().p - start().p;
  return way_.is_motion() && !line.isZero(1e-9) ? Vector3(line.normalized()) : Vector3(Vector3::Zero());
}

}  // namespace snug::motion
