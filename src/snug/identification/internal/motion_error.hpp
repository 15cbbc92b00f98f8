// compare: a simulated motion less a recorded one.
#pragma once

#include "snug/identification/internal/scene_motion.hpp"
#include "snug/identification/scene_experiment.hpp"

namespace snug::identification::internal {

/// Numbers that a recording measures: three for a position, three for a rotation, of each sample that counts.
[[nodiscard]] Eigen::Index count_residuals(const model::SceneTask& task, const RecordedMotion& motion);
/// Residuals have room for the own unknowns at their end. A sample that was not seen counts nothing.
[[nodiscard]] MotionError compare(const model::SceneTask& task, const RecordedMotion& motion,
                                  const SimulatedMotion& simulated, const OwnValues& own);

}  // namespace snug::identification::internal
