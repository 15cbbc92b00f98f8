// measure_packing: how long deciding takes and what it plans; what loading makes of public instances.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::bench::internal {

/// Planned only, one thread, default decision time: every sequence of the scenario until an item has no place.
struct DecisionFigures {
  double median_seconds = 0.0;   ///< CPU time of a decision
  double longest_seconds = 0.0;  ///< CPU time of the longest
  double planned_percent = 0.0;  ///< mean of the sequences
};
[[nodiscard]] DecisionFigures measure_decisions(const model::Scenario& scenario);

struct LoadFigure {
  std::string set;  ///< BR1 .. BR7
  double percent = 0.0;
};
/// The first instance of each set of Bischoff and Ratcliff in `folder`, `seconds` of work each. Empty: none there.
[[nodiscard]] std::vector<LoadFigure> measure_loads(const std::filesystem::path& folder, double seconds);

}  // namespace snug::bench::internal
