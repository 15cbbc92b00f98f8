// PathProfile: how far along a way the tool is at each time: as fast as limits that change along it allow, its jerk
// bounded.
#include "snug/motion/path_profile.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

constexpr double kPart = 1.0 / kPathParts;

}  // namespace

PathProfile::PathProfile(std::span<const double, kPathParts> rates, std::span<const double, kPathParts> accelerations,
                         const Smoothing& smoothing)
    : smoothing_(smoothing) {
  SNUG_CHECK(std::ranges::all_of(accelerations, is_positive) && is_positive(smoothing.window),
             "accelerations and window must be finite and positive");
  SNUG_CHECK(std::isfinite(smoothing.shaper_delay) && smoothing.shaper_delay >= 0.0,
             "the second half of a motion comes later");
  SNUG_CHECK(std::ranges::all_of(rates, [](double rate) { return rate > 0.0; }), "speeds along a way must be positive");
  // Squares of the rates at the ends of the parts: below the limits of both neighbours, reachable from either side.
  std::array<double, kPathParts + 1> square{};
  const auto gain = [&](std::size_t part) { return 2.0 * accelerations[part] * kPart; };
  for (std::size_t i = 1; i < kPathParts; ++i) {
    const double rate = std::min(rates[i - 1], rates[i]);
    square[i] = std::min(rate * rate, square[i - 1] + gain(i - 1));
  }
  for (std::size_t i = kPathParts; i-- > 0;) square[i] = std::min(square[i], square[i + 1] + gain(i));
  for (std::size_t i = 0; i <= kPathParts; ++i) rate_[i] = std::sqrt(square[i]);
  for (std::size_t i = 0; i < kPathParts; ++i) {
    const double dt = 2.0 * kPart / (rate_[i] + rate_[i + 1]);  // constant acceleration within a part
    const double share = kPart * static_cast<double>(i);
    time_[i + 1] = time_[i] + dt;
    area_[i + 1] = area_[i] + dt * (share + dt * (2.0 * rate_[i] + rate_[i + 1]) / 6.0);
  }
}

PathProfile::Raw PathProfile::raw(double t) const noexcept {
  if (!(t > 0.0)) return {};
  if (t >= time_.back()) return {1.0, area_.back() + (t - time_.back())};
  const auto next = std::upper_bound(time_.begin(), time_.end(), t);
  const auto i = static_cast<std::size_t>(next - time_.begin()) - 1;
  const double since = t - time_[i];
  const double acceleration = (rate_[i + 1] - rate_[i]) / (time_[i + 1] - time_[i]);
  const double share = kPart * static_cast<double>(i);
  return {share + since * (rate_[i] + 0.5 * acceleration * since),
          area_[i] + since * (share + since * (0.5 * rate_[i] + acceleration * since / 6.0))};
}

PathProfile::Sample PathProfile::averaged(double t) const noexcept {
  const double window = smoothing_.window;
  const Raw now = raw(t), before = raw(t - window);
  return {(now.area - before.area) / window, (now.share - before.share) / window};
}

PathProfile::Sample PathProfile::sample(double t) const noexcept {
  if (t >= duration()) return {1.0, 0.0};
  Sample sample = averaged(t);
  if (smoothing_.shaper_delay > 0.0) {
    const Sample later = averaged(t - smoothing_.shaper_delay);
    sample = {0.5 * (sample.share + later.share), 0.5 * (sample.rate + later.rate)};
  }
  sample.share = std::clamp(sample.share, 0.0, 1.0);
  return sample;
}

}  // namespace snug::motion
