// fit_limits: speeds and accelerations with which a robot that follows exactly takes as long as the simulated tool,
// which lags behind.
#pragma once

#include <vector>

#include "snug/motion/controller.hpp"

namespace snug::motion {

/// For each row of a program, limits none of which is above those of the plan: a move from stop to stop within them
/// takes as long as the tool of `plan` (Faithful) takes from leaving the row before to being within the precision of
/// this one, as far as a peak speed not above the simulated one allows. Rows that are passed in less than that keep
/// their limits.
[[nodiscard]] std::vector<MotionLimits> fit_limits(const PreparedProgram& plan, const Pose& X_WE_start);

}  // namespace snug::motion
