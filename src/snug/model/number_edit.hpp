// Number edits: a scenario with some of its numbers changed, as identification and studies want it.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "snug/model/scenario.hpp"

namespace snug::model {

/// A number in the text of a scenario. The path goes from key to key: "contacts.pairs[0].friction",
/// "bodies.cube.size[2]"; an entry of a list by its index from 0 or by its name or id.
struct NumberEdit {
  std::string path;
  double value = 0.0;
  bool operator==(const NumberEdit&) const = default;
};

/// The number that stands at `path` in the text, or nothing where a key is left out that a number may stand under.
/// Throws InputError naming `where` (who wrote the path), the step that leads nowhere and the nearest key, and for
/// something that is not a number.
[[nodiscard]] std::optional<double> find_number(const Scenario& scenario, const std::string& path,
                                                const std::string& where);

/// The scenario that its text with these numbers describes; checked as on loading: throws InputError for values that
/// cannot be. Numbers written once and used again by an alias change together.
[[nodiscard]] Scenario with_numbers(const Scenario& scenario, std::span<const NumberEdit> edits);

}  // namespace snug::model
