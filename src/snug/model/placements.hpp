// PlacementList: which box shall rest where in the container, in the order of packing, as a person or planner wrote it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model {

struct PlacementEntry {
  std::string parcel;  ///< id of a parcel of the scenario
  Pose X_TP;           ///< where it shall rest in the target container
  int line = 0;        ///< in the file, from 1
  bool operator==(const PlacementEntry&) const = default;
};

/// Reads the YAML list of docs/formats.md, or the plan that `snug pack --plan` writes. Throws InputError (file:line,
/// key, got, expected) for anything else, for a box that the scenario does not have and for one that is placed twice.
[[nodiscard]] std::vector<PlacementEntry> load_placements(const std::filesystem::path& path, const Scenario& scenario);
[[nodiscard]] std::vector<PlacementEntry> parse_placements(std::string_view text, std::string_view name,
                                                           const Scenario& scenario);

}  // namespace snug::model
