// cpu_seconds: what this process has used of its cores, for figures that other work on the machine must not change.
#pragma once

#include <ctime>

namespace snug::bench::internal {

/// s, since the process began.
[[nodiscard]] inline double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace snug::bench::internal
