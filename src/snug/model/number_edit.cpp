// Number edits: paths through the text of a scenario.
#include "snug/model/number_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <vector>

#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model {
namespace {

/// "pairs[0]" is two steps: "pairs" and "0".
std::vector<std::string> split_path(const std::string& path, const std::string& where) {
  std::vector<std::string> steps;
  std::string step;
  bool is_index = false;
  const auto finish = [&](bool may_be_empty) {
    if (step.empty() && !may_be_empty)
      throw InputError(where, "path", "'" + path + "'", "keys with dots between, such as contacts.pairs[0].friction");
    if (!step.empty()) steps.push_back(step);
    step.clear();
  };
  bool was_index = false;
  for (const char c : path) {
    if (c == '[' && !is_index) {
      finish(was_index);
      is_index = true;
    } else if (c == ']' && is_index) {
      finish(false);
      is_index = false;
      was_index = true;
    } else if (c == '.' && !is_index) {
      finish(was_index);
      was_index = false;
    } else {
      step += c;
      if (!is_index) was_index = false;
    }
  }
  finish(was_index);
  return steps;
}

std::optional<std::size_t> as_index(const std::string& step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (error != std::errc() || end != step.data() + step.size()) return std::nullopt;
  return index;
}

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

std::size_t find_entry(const YAML::Node& list, const std::string& step, const std::string& path,
                       const std::string& where) {
  std::vector<std::string> names;
  std::size_t i = 0;
  for (const YAML::Node& entry : list) {
    for (const char* key : {"name", "id"}) {
      if (!entry.IsMap() || !entry[key] || !entry[key].IsScalar()) continue;
      names.push_back(entry[key].Scalar());
      if (names.back() == step) return i;
    }
    ++i;
  }
  const std::optional<std::size_t> index = as_index(step);
  if (!index || *index >= list.size()) fail_step(where, path, step, names);
  return *index;
}

std::vector<std::string> keys_of(const YAML::Node& map) {
  std::vector<std::string> keys;
  for (const auto& entry : map)
    if (entry.first.IsScalar()) keys.push_back(entry.first.Scalar());
  return keys;
}

Place find_place(const YAML::Node& root, const std::string& path, const std::string& where) {
  const std::vector<std::string> steps = split_path(path, where);
  YAML::Node at = root;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool is_last = i + 1 == steps.size();
    if (at.IsSequence()) {
      const std::size_t index = find_entry(at, steps[i], path, where);
      if (is_last) return {at, "", index};
      at.reset(at[index]);
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
