// with_values: the text is changed and read again, so that what runs is what is written down.
#include "snug/model/scenario_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <optional>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/model/internal/key_path.hpp"
#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/internal/value.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

constexpr std::size_t kMostName = 30;  ///< characters of a name in a message

/// The names of a list's entries where they are few.
std::string describe_entries(const YAML::Node& list) {
  constexpr std::size_t kMostShown = 12;
  const std::vector<std::string> names = internal::entry_names(list);
  if (names.empty() || names.size() > kMostShown) return "an entry's name or id";
  std::string text = "one of";
  for (const std::string& name : names) text += (&name == &names.front() ? " " : ", ") + printable(name, kMostName);
  return text;
}

class Editor {
 public:
  Editor(const KeyValue& change, const std::string& where) : where_(where), path_(change.first) {
    std::optional<std::vector<std::string>> steps = internal::split_key_path(path_);
    if (!steps) refuse("'" + path_ + "'", internal::kKeyPathForm);
    steps_ = std::move(*steps);
    check_yaml(change.second, where + " " + change.first);
    value_ = YAML::Load(change.second);
  }

  /// Nodes on the way are copied: one that is an alias would change wherever it stands.
  [[nodiscard]] YAML::Node changed(const YAML::Node& node, std::size_t depth = 0) const {
    if (depth == steps_.size()) return value_;
    const std::string& step = steps_[depth];
    const YAML::Node here = node && !node.IsNull() ? node : YAML::Node(YAML::NodeType::Map);
    if (here.IsSequence()) return changed_list(here, step, depth);
    if (!here.IsMap()) refuse("'" + here.Scalar() + "' before '" + step + "'", "a mapping or a list there");
    YAML::Node copy(YAML::NodeType::Map);
    bool is_there = false;
    for (const auto& entry : here) {
      const bool is_it = entry.first.IsScalar() && entry.first.Scalar() == step;
      copy[entry.first] = is_it ? changed(entry.second, depth + 1) : entry.second;
      is_there |= is_it;
    }
    if (!is_there) copy[step] = changed(YAML::Node(YAML::NodeType::Null), depth + 1);
    copy.SetStyle(here.Style());
    return copy;
  }

 private:
  [[nodiscard]] YAML::Node changed_list(const YAML::Node& here, const std::string& step, std::size_t depth) const {
    const std::optional<std::size_t> index = internal::find_entry(here, step);
    if (!index) {
      refuse("'" + step + "'", describe_entries(here) + ", or an index below " + std::to_string(here.size()) +
                                   internal::nearest_hint(step, internal::entry_names(here)));
    }
    YAML::Node copy(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < here.size(); ++i) copy.push_back(i == *index ? changed(here[i], depth + 1) : here[i]);
    copy.SetStyle(here.Style());
    return copy;
  }
  [[noreturn]] void refuse(const std::string& got, const std::string& expected) const {
    throw InputError(where_, path_, got, expected);
  }

  std::string where_, path_;
  std::vector<std::string> steps_;
  YAML::Node value_;
};

}  // namespace

Scenario with_values(const Scenario& scenario, const std::vector<KeyValue>& values, const std::string& where) {
  if (values.empty()) return scenario;
  YAML::Node root = YAML::Load(scenario.source_text);
  std::string why = where;
  for (const KeyValue& value : values) {
    root = Editor(value, where).changed(root);
    why += " " + value.first + "=" + value.second;
  }
  const std::string text = internal::text_of(root, scenario.source_text, why);
  try {
    Scenario changed = parse_scenario(text, scenario.source_name);
    changed.name = scenario.name;
    return changed;
  } catch (const InputError& error) {  // its line is one of the changed text, which nobody has
    throw InputError(scenario.source_name + " with " + why, error.key, error.got, error.expected);
  }
}

KeyValue parse_key_value(const std::string& words, const std::string& where) {
  const std::size_t equals = words.find('=');
  if (equals == 0 || equals == std::string::npos) {
    throw InputError("command line", where, "'" + words + "'", "KEY=VALUE, such as cup.lip_radius=0.03");
  }
  return {words.substr(0, equals), words.substr(equals + 1)};
}

}  // namespace snug::model
