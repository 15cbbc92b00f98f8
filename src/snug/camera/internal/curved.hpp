// Rays against capsules and cylinders.
#pragma once

#include "snug/geometry/shape.hpp"

namespace snug::camera::internal {

/// The functions below are for capsules and cylinders only.
[[nodiscard]] Vector3 half_extent(const geometry::Shape& shape);
[[nodiscard]] bool is_inside(const geometry::Shape& shape, const Vector3& p_G);
/// Smallest s > 0 at which s ray [m, C] enters the shape; 0 when it does not. The camera is not inside.
[[nodiscard]] double hit(const geometry::Shape& shape, const Pose& X_CG, const Vector3& ray);
/// Outward unit normal at a point of the surface.
[[nodiscard]] Vector3 curved_normal(const geometry::Shape& shape, const Vector3& p_G);

}  // namespace snug::camera::internal
