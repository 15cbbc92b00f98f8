// SNUG_CHECK: stops the program on a bug of ours, in every build.
#pragma once

#include <cmath>

namespace snug {

/// What limits, times and sizes must be: finite and above 0.
[[nodiscard]] inline bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

/// Prints the message with file and line on stderr and aborts.
[[noreturn]] void fail_check(const char* condition, const char* file, int line, const char* message) noexcept;

}  // namespace snug

/// Aborts with file, line and message when `condition` is false. For bugs only; bad input throws InputError.
#define SNUG_CHECK(condition, message)                             \
  do {                                                             \
    if (!(condition)) [[unlikely]]                                 \
      ::snug::fail_check(#condition, __FILE__, __LINE__, message); \
  } while (false)
