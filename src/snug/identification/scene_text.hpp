// What was identified of a scene as text: JSON for programs, a table for people.
#pragma once

#include <string>

#include "snug/identification/scene_fit.hpp"

namespace snug::identification {

/// Keys: docs/identification.md. What is infinite is null.
[[nodiscard]] std::string format_json(const SceneError& error);
[[nodiscard]] std::string format_table(const SceneError& error);
[[nodiscard]] std::string format_json(const SceneFit& fit);
[[nodiscard]] std::string format_table(const SceneFit& fit);

}  // namespace snug::identification
