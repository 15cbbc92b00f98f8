// add_inertia: sums of inertias whose frames differ.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::robot::internal {

/// sum += part, whose frame is at X_SL in the frame of the sum; by the parallel-axis theorem about the common centre.
void add_inertia(const SpatialInertia& part, const Pose& X_SL, SpatialInertia& sum);

}  // namespace snug::robot::internal
