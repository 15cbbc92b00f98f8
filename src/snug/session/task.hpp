// Task: placements into waypoints: plain pick-and-place in the cell of a scenario.
#pragma once

#include <string>
#include <vector>

#include "snug/model/placements.hpp"
#include "snug/skills/placements.hpp"

namespace snug::session {

/// Program that picks the placed boxes at the aligner, in the order of the placements, standing as the sequence says,
/// and sets them down where the placements say. The quarter turn at the aligner is the one that lets the box be placed
/// with a turn about the vertical alone; a box that would need a flip is a reason, as is one that cannot be reached
/// from above. Throws InputError for a sequence that the scenario does not have and a box that it does not list.
[[nodiscard]] Expected<motion::Program, skills::NoProgramReason> make_program(
    const model::Scenario& scenario, const std::string& sequence, const std::vector<model::PlacementEntry>& placements,
    const std::string& placements_name);

}  // namespace snug::session
