// Key paths: "contacts.pairs[0].friction" as steps through the text of a scenario.
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace snug::model::internal {

/// How a path is written, for messages.
inline constexpr const char* kKeyPathForm = "keys with dots between, such as contacts.pairs[0].friction";

/// "pairs[0]" and "pairs.0" are two steps: "pairs" and "0". None where a step is empty or a bracket stays open.
[[nodiscard]] std::optional<std::vector<std::string>> split_key_path(std::string_view path);

/// Index of the entry of a list that a step names: by its `name` or `id`, by its `between` as "one/other", else by
/// index. None where there is none.
[[nodiscard]] std::optional<std::size_t> find_entry(const YAML::Node& list, const std::string& step);
/// What the entries of a list are called.
[[nodiscard]] std::vector<std::string> entry_names(const YAML::Node& list);

}  // namespace snug::model::internal
