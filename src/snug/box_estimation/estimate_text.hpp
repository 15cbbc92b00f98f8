// An estimate as text: JSON for programs, a table for people.
#pragma once

#include <string>

#include "snug/box_estimation/estimate.hpp"

namespace snug::box_estimation {

/// Keys: `snug perceive --help`. Poses in W, m and quaternions; covariances as PoseEstimate has them.
[[nodiscard]] std::string format_json(const Estimate& estimate);
/// With what was seen of the container from above, m.
[[nodiscard]] std::string format_json_with_heights(const Estimate& estimate);
[[nodiscard]] std::string format_table(const Estimate& estimate);

}  // namespace snug::box_estimation
