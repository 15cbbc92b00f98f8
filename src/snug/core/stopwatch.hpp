// Stopwatch: how long something took, for people; results never depend on it.
#pragma once

#include <chrono>

namespace snug {

/// s
[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace snug
