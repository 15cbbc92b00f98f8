// compare: a simulated motion less a recorded one.
#pragma once

#include "snug/identification/internal/scene_motion.hpp"
#include "snug/identification/scene_experiment.hpp"

namespace snug::identification::internal {

/// m and rad: what a sample without a simulation counts as.
inline constexpr double kLost = 1.0;

/// Numbers that a sample measures: three for a position, three for a rotation, as far as they are used.
[[nodiscard]] int numbers_of(const model::SceneTask& task);
/// Residuals stand body by body in order of time, and have room for the own unknowns at their end. Samples after
/// `until`, s on the recording's clock, and those that the simulation does not have count nothing.
[[nodiscard]] MotionError compare(const model::SceneTask& task, const RecordedMotion& motion,
                                  const ComparedSamples& samples, const SimulatedMotion& simulated,
                                  const OwnValues& own, double until);

}  // namespace snug::identification::internal
