// with_values: a scenario with some of its keys changed, written down as if the file had them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model {

/// A key by its path from the top of the file, such as `cup.lip_radius`, `parcels.BOX013.mass` or
/// `contacts.pairs.box/container.friction`: entries of lists by index, from 0 (also `pairs[0]`), by their `name` or
/// `id`, or by what they are `between`. The value as YAML.
using KeyValue = std::pair<std::string, std::string>;

/// The scenario with these keys set, in this order; its text says so. Keys that the file leaves out are added. Throws
/// InputError for a path that leads nowhere and for what the scenario's reader refuses; `where` (an option, say) is
/// named in messages.
[[nodiscard]] Scenario with_values(const Scenario& scenario, const std::vector<KeyValue>& values,
                                   const std::string& where);
/// "key=value" in two. Throws InputError for words without `=` or key.
[[nodiscard]] KeyValue parse_key_value(const std::string& words, const std::string& where);

}  // namespace snug::model
