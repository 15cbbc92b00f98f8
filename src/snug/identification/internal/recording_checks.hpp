// Recordings that are not what they seem: other units, another order of the quaternion, samples that jump.
#pragma once

#include "snug/identification/recorded_motion.hpp"
#include "snug/model/scenario.hpp"

namespace snug::identification::internal {

/// Throws InputError that names what the numbers look like instead: times in milliseconds, positions in millimetres,
/// quaternions as x, y, z, w, a body turned by half a turn from the scenario's, one that flips and stays so.
void check_conventions(const model::SceneTask& task, const model::Scenario& scenario, const RecordedMotion& motion);

/// Samples of tracked bodies that lie further from the line through their neighbours than eight times the noise, and
/// six times what those scatter about it, become lost, and are counted (RecordedBody::rejected). Where that is more
/// than a tenth of a body's samples, none does: what is so common is no outlier. Those with fewer than four neighbours
/// within three samples stay: the first one and the last.
void reject_jumps(const model::SceneTask& task, RecordedMotion& motion);

}  // namespace snug::identification::internal
