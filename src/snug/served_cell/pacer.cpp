// Pacer: when the next step is due by a monotonic clock, and how late the steps were.
#include "snug/served_cell/pacer.hpp"

#include <algorithm>
#include <cmath>

namespace snug::served_cell {
namespace {

constexpr double kSmallest = 1e-7;  ///< s, upper edge of the first bin
constexpr double kGrowth = 1.05;
constexpr double kMostLate = 0.25;  ///< s

}  // namespace

void Histogram::add(double seconds) {
  const double place = seconds > kSmallest ? std::ceil(std::log(seconds / kSmallest) / std::log(kGrowth)) : 0.0;
  ++bins_[static_cast<std::size_t>(std::min(place, static_cast<double>(bins_.size() - 1)))];
  ++count_;
  worst_ = std::max(worst_, seconds);
}

double Histogram::quantile(double fraction) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(fraction * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    seen += bins_[i];
    if (seen > 0 && seen >= wanted) return std::min(worst_, kSmallest * std::pow(kGrowth, static_cast<double>(i)));
  }
  return worst_;
}

void Pacer::start(Clock::time_point now) {
  is_started_ = true;
  origin_ = now;
  steps_ = 0;
}

Pacer::Clock::time_point Pacer::due() const {
  const std::chrono::duration<double> after(static_cast<double>(steps_) * period_);
  return origin_ + std::chrono::duration_cast<Clock::duration>(after);
}

void Pacer::step(Clock::time_point now) {
  const double late = std::max(0.0, std::chrono::duration<double>(now - due()).count());
  lateness_.add(late);
  if (late > period_) ++missed_;
  if (late > kMostLate) start(now);
  ++steps_;
}

}  // namespace snug::served_cell
