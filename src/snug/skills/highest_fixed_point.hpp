// Obstacles: how high the fixed things of a cell reach, which a tool passes over on its way.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::skills {

/// m, z in W of the highest point of all that is fixed, boxes, capsules and hulls alike: static bodies, the aligner
/// with its plates and what boxes stand on there, the containers other than the target, whose rim is known to the
/// planner. The scenario must have an aligner (checked).
[[nodiscard]] double highest_fixed_point(const model::Scenario& scenario);

}  // namespace snug::skills
