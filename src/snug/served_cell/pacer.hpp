// Pacer: when the next step is due by a monotonic clock, and how late the steps were.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace snug::served_cell {

/// Numbers of any size in a fixed room: counted in bins that grow by 5 %, from 0.1 us to 100 s.
class Histogram {
 public:
  void add(double seconds);
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double worst() const { return worst_; }
  /// Upper edge of the bin that a fraction 0 .. 1 of all numbers is not beyond, s; at most the worst.
  [[nodiscard]] double quantile(double fraction) const;

 private:
  std::array<std::int64_t, 426> bins_{};
  std::int64_t count_ = 0;
  double worst_ = 0.0;
};

class Pacer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `period`: s of the clock from step to step.
  explicit Pacer(double period) : period_(period) {}

  /// The next step is due now, those after it a period each.
  void start(Clock::time_point now);
  void stop() { is_started_ = false; }
  [[nodiscard]] bool is_started() const { return is_started_; }
  [[nodiscard]] Clock::time_point due() const;
  /// A step begins. One that is more than a quarter of a second late moves the whole schedule.
  void step(Clock::time_point now);

  [[nodiscard]] const Histogram& lateness() const { return lateness_; }
  /// Steps that began more than a period late.
  [[nodiscard]] std::int64_t missed() const { return missed_; }

 private:
  double period_;
  bool is_started_ = false;
  Clock::time_point origin_{};
  std::int64_t steps_ = 0;  ///< since the origin
  Histogram lateness_;
  std::int64_t missed_ = 0;
};

}  // namespace snug::served_cell
