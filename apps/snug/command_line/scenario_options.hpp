// The words with which several verbs change a scenario: more boxes, another container, a pallet, single keys.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {

struct ScenarioChanges {
  std::vector<std::string> items;        ///< files with more boxes and sequences
  std::optional<std::string> container;  ///< name, or LxWxH in mm
  std::optional<std::string> pallet;     ///< LxW or LxWxH in mm
  std::vector<std::string> set;          ///< KEY=VALUE
  [[nodiscard]] bool any() const { return !items.empty() || container || pallet || !set.empty(); }
};

/// --items, --container, --pallet and --set.
void add_scenario_changes(const Verb& verb, ScenarioChanges& changes);
/// Options with their values, in the order of the words.
using OptionWords = std::vector<std::pair<std::string, std::string>>;
/// The words that change a scenario so.
[[nodiscard]] OptionWords words_of(const ScenarioChanges& changes);
/// What is read for load_changed() and for the robot of the scenario that it returned.
[[nodiscard]] NamedFiles files_of(const std::string& file, const ScenarioChanges& changes,
                                  const model::Scenario& scenario);
/// The scenario of a file, changed so; its text says the same. Throws InputError for what cannot be used.
[[nodiscard]] model::Scenario load_changed(const std::string& file, const ScenarioChanges& changes);

/// The same, and which of its parcels came from which file.
struct SourcedScenario {
  model::Scenario scenario;
  std::vector<std::size_t> ends;  ///< index behind the last parcel of the scenario file, and of each --items file
};
[[nodiscard]] SourcedScenario load_with_sources(const std::string& file, const ScenarioChanges& changes);

}  // namespace snug::app
