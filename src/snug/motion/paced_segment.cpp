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

/// The average over the window lowers accelerations. Twice the limit goes into it where no more than the limit comes
/// out: on ways that are never faster than the limit times the window; and, where half of the motion comes so much
/// later that both halves do not speed up at once, in the first half of the way. Slowing down there may end in contact.
constexpr double kBeforeAverage = 2.0;

void use_average(std::span<const double> rates, const Pace& pace, std::span<double> accelerations) {
  bool is_slow = true, is_apart = pace.shaper_delay > 0.0;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    is_slow = is_slow && rates[i] <= accelerations[i] * pace.window;
    is_apart = is_apart && rates[i] / (kBeforeAverage * accelerations[i]) + pace.window <= pace.shaper_delay;
  }
  if (!is_slow && !is_apart) return;
  const std::size_t parts = is_slow ? accelerations.size() : accelerations.size() / 2;
  for (double& one : accelerations.first(parts)) one *= kBeforeAverage;
}

}  // namespace

PacedSegment::PacedSegment(const Way& way, const Pace& pace, const PathLimits* others) : way_(way) {
  if (!way.is_motion()) return;
  std::array<double, kPathParts> rates{}, accelerations{};
  Most before = most_at(way, pace, 0.0);
  for (std::size_t i = 0; i < kPathParts; ++i) {
    const Most after = most_at(way, pace, static_cast<double>(i + 1) / kPathParts);
    rates[i] = std::min(before.rate, after.rate);
    accelerations[i] = std::min(before.acceleration, after.acceleration);
    before = after;
  }
  if (others != nullptr) others->limit(way, rates, accelerations);
  use_average(rates, pace, accelerations);
  profile_ = PathProfile(rates, accelerations, {pace.window, pace.shaper_delay});
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
