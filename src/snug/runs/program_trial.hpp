// try_motion: a prepared program done in a cell with contact, to see whether a robot may be sent to do it.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/control/joint_run.hpp"

namespace snug::runs {

struct MotionTrial {
  double duration = 0.0;               ///< s
  cell::Failure failure;               ///< why it had to stop
  std::vector<cell::BoxResult> boxes;  ///< of the sequence, after boxes have settled
  /// Boxes that rows of the program pick by their names (Box...), and that wait at the aligner all the same.
  std::vector<std::string> left_waiting;
  /// Where the vacuum came on and went off again without a box: "PostPick(BOX027): the face is out of reach".
  std::vector<std::string> missed_seals;
  /// With a robot: what its joints did, until they rested.
  control::JointRun joints;
};

/// Runs the program of `plan`, whose limits need not be the scenario's, to its end and until boxes have settled.
[[nodiscard]] MotionTrial try_motion(const cell::Simulation& simulation, const motion::PreparedProgram& plan);

/// What is worse in `trial` than in `wanted`: "protective stop ...", or the boxes that were packed there and are not
/// here ("BOX016 is dropped, not packed"); empty when nothing is.
[[nodiscard]] std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial);

/// Why a trial is no success by itself: its failure, or where nothing was sealed, and the boxes that the program picks
/// and does not pack; empty when there are none. Boxes that no row picks may wait.
[[nodiscard]] std::string find_loss(const MotionTrial& trial);

}  // namespace snug::runs
