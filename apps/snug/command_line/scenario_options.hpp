// The words with which several verbs change a scenario: more boxes, another container, a pallet, single keys.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/model/scenario_changes.hpp"

namespace snug::app {

using model::ScenarioChanges;

/// --items, --container, --pallet and --set.
void add_scenario_changes(const Verb& verb, ScenarioChanges& changes);
/// Options with their values, in the order of the words.
using OptionWords = std::vector<std::pair<std::string, std::string>>;
/// What is read for load_changed() and for the robot of the scenario that it returned.
[[nodiscard]] NamedFiles files_of(const std::string& file, const ScenarioChanges& changes,
                                  const model::Scenario& scenario);
/// The scenario that a word names, changed so; its warnings are printed. Throws InputError for what cannot be used.
[[nodiscard]] model::Scenario load_changed(const std::string& file, const ScenarioChanges& changes);

}  // namespace snug::app
