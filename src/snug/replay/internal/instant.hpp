// Instant: which frame of a recording stands for a time. Internal to the module.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace snug::replay::internal {

/// Index of the frame nearest to `time`, s; of the last one without. `times` is not empty and grows.
[[nodiscard]] inline std::size_t nearest_frame(const std::vector<double>& times, const std::optional<double>& time) {
  if (!time) return times.size() - 1;
  const auto after = std::ranges::lower_bound(times, *time);
  const auto index = static_cast<std::size_t>(after - times.begin());
  if (index == times.size()) return index - 1;
  return index > 0 && *time - times[index - 1] <= times[index] - *time ? index - 1 : index;
}

}  // namespace snug::replay::internal
