// try_motion: a prepared program done in a cell with contact, to see whether a robot may be sent to do it.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"

namespace snug::cell {

struct MotionTrial {
  double duration = 0.0;  ///< s
  std::string failure;  ///< why it had to stop: a protective stop, a body that left the cell, ...; empty if it did not
  std::vector<BoxResult> boxes;  ///< of the sequence, after boxes have settled
};

/// Runs the program of `plan`, whose limits need not be the scenario's, to its end and until boxes have settled.
[[nodiscard]] MotionTrial try_motion(const Simulation& simulation, const motion::PreparedProgram& plan);

/// What is worse in `trial` than in `wanted`: "protective stop ...", or the boxes that were packed there and are not
/// here
/// ("BOX016 is dropped, not packed"); empty when nothing is.
[[nodiscard]] std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial);

}  // namespace snug::cell
