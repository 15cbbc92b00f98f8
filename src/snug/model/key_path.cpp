// Key paths: "contacts.pairs[0].friction" as steps through the text of a scenario.
#include "snug/model/internal/key_path.hpp"

#include <algorithm>
#include <charconv>

namespace snug::model::internal {
namespace {

std::vector<std::string> names_of(const YAML::Node& entry) {
  std::vector<std::string> names;
  if (!entry.IsMap()) return names;
  for (const char* key : {"name", "id"}) {
    const YAML::Node named = entry[key];
    if (named && named.IsScalar()) names.push_back(named.Scalar());
  }
  const YAML::Node pair = entry["between"];
  if (pair && pair.IsSequence() && pair.size() == 2 && pair[0].IsScalar() && pair[1].IsScalar()) {
    names.push_back(pair[0].Scalar() + "/" + pair[1].Scalar());
  }
  return names;
}

}  // namespace

std::optional<std::vector<std::string>> split_key_path(std::string_view path) {
  std::vector<std::string> steps(1);
  bool is_index = false, was_index = false;  // inside brackets; right behind them
  for (const char c : path) {
    if (c == ']') {
      if (!is_index || steps.back().empty()) return std::nullopt;
      is_index = false;
      was_index = true;
    } else if (!is_index && (c == '.' || c == '[')) {
      if (steps.back().empty()) return std::nullopt;
      steps.emplace_back();
      is_index = c == '[';
      was_index = false;
    } else {
      if (was_index) return std::nullopt;
      steps.back() += c;
    }
  }
  if (is_index || steps.back().empty()) return std::nullopt;
  return steps;
}

std::optional<std::size_t> find_entry(const YAML::Node& list, const std::string& step) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::vector<std::string> names = names_of(list[i]);
    if (std::ranges::find(names, step) != names.end()) return i;
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  const bool is_one = error == std::errc{} && end == step.data() + step.size() && index < list.size();
  return is_one ? std::optional(index) : std::nullopt;
}

std::vector<std::string> entry_names(const YAML::Node& list) {
  std::vector<std::string> all;
  for (const YAML::Node& entry : list) {
    const std::vector<std::string> names = names_of(entry);
    all.insert(all.end(), names.begin(), names.end());
  }
  return all;
}

}  // namespace snug::model::internal
