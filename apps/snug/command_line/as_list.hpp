// as_list: vectors in the program's JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "snug/spatial/pose.hpp"

namespace snug::app {

[[nodiscard]] inline nlohmann::ordered_json as_list(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace snug::app
