// ScenarioChanges: more boxes, another container, a pallet, single keys: what is said of a scenario for one run.
#include "snug/model/scenario_changes.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/model/items_file.hpp"
#include "snug/model/other_container.hpp"
#include "snug/model/scenario_edit.hpp"

namespace snug::model {

std::vector<std::pair<std::string, std::string>> words_of(const ScenarioChanges& changes) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const std::string& file : changes.items) words.emplace_back("--items", file);
  if (changes.container) words.emplace_back("--container", *changes.container);
  if (changes.pallet) words.emplace_back("--pallet", *changes.pallet);
  for (const std::string& change : changes.set) words.emplace_back("--set", change);
  return words;
}

Scenario load_changed(const std::filesystem::path& file, const ScenarioChanges& changes,
                      const std::function<std::string(const std::string&)>& find_file) {
  Scenario scenario = load_scenario(file);
  std::vector<KeyValue> values;
  for (const std::string& words : changes.set) values.push_back(parse_key_value(words, "--set"));
  scenario = with_values(scenario, values, "--set");
  if (changes.container) scenario = with_container(scenario, *changes.container);
  if (changes.pallet) scenario = with_pallet(scenario, *changes.pallet);
  for (const std::string& items : changes.items) add_items(scenario, find_file ? find_file(items) : items);
  return scenario;
}

Scenario with_time_step(Scenario scenario, double longest) {
  if (!(longest > 0.0)) return scenario;
  const double parts = std::max(1.0, std::ceil(scenario.controller.tick / longest - 1e-9));
  scenario.time_step = std::max(scenario.time_step, scenario.controller.tick / parts);
  return scenario;
}

const Parcel& require_parcel(const Scenario& scenario, const std::string& id, std::string_view option) {
  if (const Parcel* parcel = find_parcel(scenario, id)) return *parcel;
  std::vector<std::string> ids;
  for (const Parcel& one : scenario.parcels) ids.push_back(one.id);
  const std::string_view nearest = find_nearest(id, ids);
  throw InputError(
      "command line", std::string(option), "'" + id + "'",
      nearest.empty() ? "a parcel of the scenario" : "a parcel of the scenario, nearest is " + std::string(nearest));
}

void leave_out(Scenario& scenario, const std::string& sequence, const std::vector<std::string>& boxes) {
  for (Sequence& one : scenario.sequences) {
    if (one.name != sequence) continue;
    for (const std::string& box : boxes) {
      const auto is_it = [&](const Item& item) { return item.parcel == box; };
      if (std::erase_if(one.items, is_it) > 0) continue;
      std::vector<std::string> names;
      for (const Item& item : one.items) names.push_back(item.parcel);
      throw InputError(
          "command line", "--skip", "'" + box + "'",
          "a box of sequence " + sequence + ", nearest is '" + std::string(find_nearest(box, names)) + "'");
    }
  }
}

}  // namespace snug::model
