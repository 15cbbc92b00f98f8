// measure_motions: how long it takes to plan one item's motion.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::bench::internal {

/// Planned only, one thread, no rehearsal: for every item of the scenario's sequences and the first places that its
/// decision names, from the intent to the timed motion: waypoints of pick and place around the robot's base, the
/// joints' reach along every way, and the motion within the joints' limits, sampled at every tick. Boxes that have to
/// be set down to be turned are left out: theirs are two motions with a look in between.
struct MotionFigures {
  int count = 0;
  double median_seconds = 0.0;  ///< CPU time
  double p99_seconds = 0.0;     ///< CPU time that 99 of 100 motions take at most
  double longest_seconds = 0.0;
};
[[nodiscard]] MotionFigures measure_motions(const model::Scenario& scenario);

}  // namespace snug::bench::internal
