// The scenario that a recording was made with.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"
#include "snug/record/recording.hpp"

namespace snug::replay::internal {

/// None where this version does not read it: it was made by another one, and what only the scenario tells is left out.
[[nodiscard]] std::optional<model::Scenario> scenario_of(const record::RecordingHeader& header);

}  // namespace snug::replay::internal
