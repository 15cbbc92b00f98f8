// parse_text: parse_scenario, telling also which keys the reader knows (for the test of docs/scenario.md).
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "snug/model/scenario.hpp"

namespace snug::model::internal {

/// Adds "kind.key" of each key of each mapping that was read.
[[nodiscard]] Scenario parse_text(std::string_view text, std::string_view name, std::set<std::string>* known_keys);

}  // namespace snug::model::internal
