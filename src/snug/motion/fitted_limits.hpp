// fit_limits: speeds and accelerations with which a robot that follows exactly takes as long as the simulated tool,
// which lags behind.
#pragma once

#include <vector>

#include "snug/motion/controller.hpp"

namespace snug::motion {

/// For each row of a program, limits none of which is above those of the plan: a move from stop to stop within them
/// takes as long as the tool of `plan` (lagged tracking) takes from leaving the row before to being within the
/// precision of this one, at a peak speed not above the simulated one where that suffices. Rows that are passed in less
/// time than the plan's limits take to go all of their way keep these limits.
[[nodiscard]] std::vector<MotionLimits> fit_limits(const PreparedProgram& plan, const Pose& X_WE_start);

}  // namespace snug::motion
