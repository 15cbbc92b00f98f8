// SpinWait: waiting for a message that comes at once, without sleeping: waking an idle core takes longer than a step.
#pragma once

#include <sched.h>

#include <algorithm>
#include <chrono>

namespace snug::click::wire {

class SpinWait {
 public:
  using Clock = std::chrono::steady_clock;

  /// Until ready() is true, half a millisecond from `start`, or `end`. Where all cores are busy, yielding costs the
  /// turn of a whole time slice, which sleeping does not: then the next waits do not spin.
  template <class Ready>
  [[nodiscard]] bool wait(const Ready& ready, Clock::time_point start,
                          Clock::time_point end = Clock::time_point::max()) {
    if (ready()) return true;
    if (left_out_ > 0) {
      --left_out_;
      return false;
    }
    end = std::min(end, start + kLongest);
    for (Clock::time_point now = Clock::now(); now < end;) {
      ::sched_yield();
      const Clock::time_point before = now;
      now = Clock::now();
      const bool is_ready = ready();
      if (now - before > kLostTurn) {
        left_out_ = kLeftOut;
        return is_ready;
      }
      if (is_ready) return true;
    }
    return false;
  }

 private:
  static constexpr auto kLongest = std::chrono::microseconds(500);
  static constexpr auto kLostTurn = std::chrono::microseconds(200);
  static constexpr int kLeftOut = 500;  // waits

  int left_out_ = 0;
};

}  // namespace snug::click::wire
