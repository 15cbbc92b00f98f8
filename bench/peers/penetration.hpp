// Penetration: how deep boxes stand in each other, found from their poses alone and not by any engine's collision code.
#pragma once

#include <vector>

#include "peers/scenes.hpp"

namespace snug::peers {

/// Smallest overlap over the 15 separating axes of two boxes, m; not positive when they are apart.
[[nodiscard]] double box_box_depth(const Vector3& half_a, const Pose& X_WA, const Vector3& half_b, const Pose& X_WB);

/// Height of the lowest corner, m.
[[nodiscard]] double lowest_corner(const Vector3& half, const Pose& X_WB);

/// Largest depth over all pairs with a free box, and over the plane, m; 0 when nothing overlaps. poses: one per body
/// of the scene; bodies not marked in `present` are left out.
[[nodiscard]] double worst_depth(const Scene& scene, const std::vector<Pose>& poses, const std::vector<bool>& present);

}  // namespace snug::peers
