// What the report states of the real experiment, to set our figures beside.
#pragma once

#include <string>
#include <vector>

#include "snug/validation/validate.hpp"

namespace snug::validation {

/// Means of all values of Tables 4, 5 and 6 (of all five sequences): 8.5 mm, 1.8 degrees; 23.5 mm, 3.1 degrees; 20.2 N,
/// 1.5 Nm. SI.
[[nodiscard]] const Means& reported_means();

struct KeyMoment {
  const char* sequence;
  const char* body;
  const char* what;  ///< "flipping" or "packing"
};
/// Table 3.
[[nodiscard]] const std::vector<KeyMoment>& key_moments();

}  // namespace snug::validation
