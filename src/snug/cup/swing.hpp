// Swing: how slowly a held box swings under the cup, for motions that shall not leave it swinging.
#pragma once

#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup {

/// Periods of small free vibrations, s: the two longest of the six.
struct Swing {
  double slow = 0.0;
  double fast = 0.0;
  bool operator==(const Swing&) const = default;
};

/// Of a box that hangs under a gripper at rest, pointing down, without damping. `box_S`: mass, centre of mass from the
/// lip, and inertia about it, in S (z into the box). Of the weight the restoring moment of what hangs below the cup's
/// centre counts. Infinite where nothing holds the box in some direction, or its inertia is not positive.
[[nodiscard]] Swing find_swing(const model::CupParams& params, const SpatialInertia& box_S, double gravity);

/// Mass, centre of mass from the lip, and inertia about it, in S, of a box that is picked up as it stands, with `up_P`
/// (along an axis of P) up, over its centre of mass as far as the disc on which the vacuum acts stays on the face.
[[nodiscard]] SpatialInertia box_below_lip(const model::CupParams& params, const SpatialInertia& box,
                                           const Vector3& size, const Vector3& up_P);
/// find_swing of such a box.
[[nodiscard]] Swing find_swing(const model::CupParams& params, const SpatialInertia& box, const Vector3& size,
                               const Vector3& up_P, double gravity);

}  // namespace snug::cup
