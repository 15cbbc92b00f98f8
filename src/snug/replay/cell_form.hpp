// CellForm: a cell as it stands before anything is done, in the replay form: one frame, for who draws it.
#pragma once

#include <string>

#include "snug/model/scenario.hpp"

namespace snug::replay {

/// Everything that stands there at time 0, and the arm at its start, or where that is out of reach in its posture; no
/// boxes. Where the robot's file is not there the tool alone is shown. Throws InputError as robot::load_arm.
[[nodiscard]] std::string encode_cell(const model::Scenario& scenario);

}  // namespace snug::replay
