// Surroundings: what a box meets around the place it shall have: support, neighbours, walls.
#pragma once

#include "snug/packing/container_state.hpp"
#include "snug/packing/placement.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::skills {

/// The candidate with side_gap and side_height measured in `state`, and z on what carries it there. `size`: of the box,
/// and `shrink` is taken from every size: boxes collide as if they were smaller by it. Of `params`: graze and inside.
[[nodiscard]] packing::Candidate measured(const packing::ContainerState& state, packing::Candidate candidate,
                                          const Vector3& size, double shrink,
                                          const settings::InsertionParams& params = {});

}  // namespace snug::skills
