// Scenario names: the scenarios that come with snug, and which file a name means.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snug::model {

/// The scenarios below `folder`, sorted: paths from there without `.yaml` ("box-demonstrator", "bench/s6a"). Files of
/// other kinds (placements, tasks, calibrations) have no key `bodies` and are left out. Empty where there is no folder.
[[nodiscard]] std::vector<std::string> list_scenarios(const std::filesystem::path& folder);

/// Which file `words` mean; `folder` holds the scenarios that come with snug (empty: none). In this order: the file
/// itself, `words`.yaml from the current folder, `words` beside `folder` ("scenarios/drop.yaml"), `words` or
/// `words`.yaml in it. A path with the ending of a YAML file that is nowhere is returned as it is, for the reader to
/// complain about. Throws InputError with the nearest name for a name that is nowhere.
[[nodiscard]] std::filesystem::path find_scenario_file(const std::string& words, const std::filesystem::path& folder);

}  // namespace snug::model
