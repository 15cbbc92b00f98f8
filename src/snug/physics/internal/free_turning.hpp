// Free turning: Euler's equations of one body over a step.
#pragma once

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {

/// Angular velocity at the end of a step, rad/s, W, under the impulse of a torque [N m s, W], by the implicit midpoint
/// rule in as many parts as it takes. docs/decisions/0139.
[[nodiscard]] Vector3 turn_freely(const WorldModel::MassProperties& mass, const BodyWork& body, const Vector3& torque_W,
                                  double dt);

}  // namespace snug::physics::internal
