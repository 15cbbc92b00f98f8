// Bounds of what options count: threads, memory and patience end somewhere.
#pragma once

#include "apps/snug/command_line/options.hpp"

namespace snug::app {

inline constexpr std::uint64_t kMostThreads = 256;
inline constexpr std::uint64_t kMostRuns = 10'000;       ///< of repeated runs
inline constexpr std::uint64_t kMostSequences = 1000;    ///< about as many as one scenario can hold with their items
inline constexpr std::uint64_t kMostThings = 1'000'000;  ///< frames, problems

/// A number from `low` to `high`.
[[nodiscard]] Check within(double low, double high);

}  // namespace snug::app
