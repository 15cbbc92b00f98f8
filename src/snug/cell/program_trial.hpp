// try_motion: a prepared program done in a cell with contact, to see whether a robot may be sent to do it.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/control/joint_run.hpp"

namespace snug::cell {

struct MotionTrial {
  double duration = 0.0;         ///< s
  Failure failure;               ///< why it had to stop
  std::vector<BoxResult> boxes;  ///< of the sequence, after boxes have settled
  /// With a robot: what its joints did, until they rested.
  control::JointRun joints;
};

/// Runs the program of `plan`, whose limits need not be the scenario's, to its end and until boxes have settled.
[[nodiscard]] MotionTrial try_motion(const Simulation& simulation, const motion::PreparedProgram& plan);

/// What is worse in `trial` than in `wanted`: "protective stop ...", or the boxes that were packed there and are not
/// here
/// ("BOX016 is dropped, not packed"); empty when nothing is.
[[nodiscard]] std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial);

/// Why a trial is no success by itself: its failure, or the boxes that were taken from where they came and are not
/// packed; empty when there are none.
[[nodiscard]] std::string find_loss(const MotionTrial& trial);

}  // namespace snug::cell
