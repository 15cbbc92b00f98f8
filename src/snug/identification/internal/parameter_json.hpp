// Parameters in the JSON of what was identified. Internal.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "snug/identification/parameter.hpp"

namespace snug::identification::internal {

/// A list; `record_instead` where there is advice.
[[nodiscard]] inline nlohmann::ordered_json describe_parameters(const std::vector<Parameter>& parameters) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Parameter& parameter : parameters) {
    list.push_back({{"name", parameter.name},
                    {"value", parameter.value},
                    {"standard_error", parameter.standard_error},
                    {"unit", parameter.unit},
                    {"verdict", name_of(parameter.verdict)}});
    if (!parameter.advice.empty()) list.back()["record_instead"] = parameter.advice;
  }
  return list;
}

}  // namespace snug::identification::internal
