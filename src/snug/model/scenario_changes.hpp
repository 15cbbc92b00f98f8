// ScenarioChanges: more boxes, another container, a pallet, single keys: what is said of a scenario for one run.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model {

struct ScenarioChanges {
  std::vector<std::string> items;        ///< files with more boxes and sequences
  std::optional<std::string> container;  ///< name, or LxWxH in mm
  std::optional<std::string> pallet;     ///< LxW or LxWxH in mm
  std::vector<std::string> set;          ///< KEY=VALUE
  [[nodiscard]] bool any() const { return !items.empty() || container || pallet || !set.empty(); }
};

/// The options --items, --container, --pallet and --set with their values, in the order in which they are applied.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> words_of(const ScenarioChanges& changes);

/// The scenario of a file, changed so; its text says the same. `find_file`: where a file of --items is; empty: where it
/// says. Throws InputError for what cannot be used.
[[nodiscard]] Scenario load_changed(const std::filesystem::path& file, const ScenarioChanges& changes,
                                    const std::function<std::string(const std::string&)>& find_file = {});

/// With time steps as long as `longest` [s] allows, in whole parts of the controller's tick and no shorter than the
/// scenario's; 0: the scenario's.
[[nodiscard]] Scenario with_time_step(Scenario scenario, double longest);

/// The box that `option` of a command line names. Throws InputError where there is none, with the nearest.
[[nodiscard]] const Parcel& require_parcel(const Scenario& scenario, const std::string& id, std::string_view option);
/// Takes boxes out of a sequence. Throws InputError for one that is not in it, with the nearest.
void leave_out(Scenario& scenario, const std::string& sequence, const std::vector<std::string>& boxes);

}  // namespace snug::model
