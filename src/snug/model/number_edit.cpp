// Number edits: paths through the text of a scenario.
#include "snug/model/number_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <vector>

#include "snug/model/internal/key_path.hpp"
#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model {
namespace {

/// Where the last step of a path stands.
struct Place {
  YAML::Node parent;
  std::string key;    ///< of a mapping
  std::size_t index;  ///< of a list
};

[[noreturn]] void fail_step(const std::string& where, const std::string& path, const std::string& step,
                            const std::vector<std::string>& known) {
  throw InputError(where, path, "'" + step + "', which leads nowhere in the scenario",
                   "a number of the scenario" + internal::nearest_hint(step, known));
}

std::vector<std::string> keys_of(const YAML::Node& map) {
  std::vector<std::string> keys;
  for (const auto& entry : map)
    if (entry.first.IsScalar()) keys.push_back(entry.first.Scalar());
  return keys;
}

Place find_place(const YAML::Node& root, const std::string& path, const std::string& where) {
  const std::optional<std::vector<std::string>> split = internal::split_key_path(path);
  if (!split) throw InputError(where, "path", "'" + path + "'", internal::kKeyPathForm);
  const std::vector<std::string>& steps = *split;
  YAML::Node at = root;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool is_last = i + 1 == steps.size();
    if (at.IsSequence()) {
      const std::optional<std::size_t> index = internal::find_entry(at, steps[i]);
      if (!index) fail_step(where, path, steps[i], internal::entry_names(at));
      if (is_last) return {at, "", *index};
      at.reset(at[*index]);
    } else if (at.IsMap()) {
      if (is_last) return {at, steps[i], 0};
      const YAML::Node next = at[steps[i]];
      if (!next) fail_step(where, path, steps[i], keys_of(at));
      at.reset(next);
    } else {
      fail_step(where, path, steps[i], {});
    }
  }
  fail_step(where, path, path, {});
}

}  // namespace

std::optional<double> find_number(const Scenario& scenario, const std::string& path, const std::string& where) {
  const Place place = find_place(YAML::Load(scenario.source_text), path, where);
  const YAML::Node node = place.key.empty() ? place.parent[place.index] : place.parent[place.key];
  if (!node) {
    // A number with a default may be left out; the reader knows whether such a key exists.
    try {
      (void)with_numbers(scenario, std::vector<NumberEdit>{{path, 1.0}});
    } catch (const InputError& error) {
      if (error.expected.find("key") != std::string::npos || error.got.find("key") != std::string::npos) throw;
    }
    return std::nullopt;
  }
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value))
    throw InputError(where, path, node.IsScalar() ? "'" + node.Scalar() + "'" : "a list or a mapping",
                     "the path of a single number");
  return value;
}

Scenario with_numbers(const Scenario& scenario, std::span<const NumberEdit> edits) {
  const YAML::Node root = YAML::Load(scenario.source_text);
  for (const NumberEdit& edit : edits) {
    Place place = find_place(root, edit.path, scenario.source_name);
    if (place.key.empty())
      place.parent[place.index] = internal::to_text(edit.value);
    else
      place.parent[place.key] = internal::to_text(edit.value);
  }
  Scenario changed = parse_scenario(internal::text_of(root), scenario.source_name);
  if (changed.name == changed.source_name) changed.name = scenario.name;
  return changed;
}

}  // namespace snug::model
