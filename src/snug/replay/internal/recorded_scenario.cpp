// The scenario that a recording was made with.
#include "snug/replay/internal/recorded_scenario.hpp"

#include "snug/core/input_error.hpp"

namespace snug::replay::internal {

std::optional<model::Scenario> scenario_of(const record::RecordingHeader& header) {
  try {
    return model::parse_scenario(header.scenario_text, "scenario of the recording");
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace snug::replay::internal
