// Aabb: the axis-aligned box around a shape in the world, for the broad phase.
#pragma once

#include "snug/geometry/shape.hpp"

namespace snug::geometry {

/// Axis-aligned box in the world.
struct Aabb {
  Vector3 lower = Vector3::Zero();  ///< m, world
  Vector3 upper = Vector3::Zero();  ///< m, world
  bool operator==(const Aabb&) const = default;

  [[nodiscard]] bool overlaps(const Aabb& other) const noexcept {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
  /// Grown by `margin` [m] on every side.
  [[nodiscard]] Aabb inflated(double margin) const noexcept {
    return {lower - Vector3::Constant(margin), upper + Vector3::Constant(margin)};
  }
};

/// Smallest axis-aligned box that contains the shape G at pose X_WG.
[[nodiscard]] Aabb bounds(const Shape& shape, const Pose& X_WG) noexcept;
/// How far a cylinder reaches from its centre along each world axis, m.
[[nodiscard]] Vector3 half_extent(const Cylinder& cylinder, const Matrix3& R_WG) noexcept;
/// Farthest point of a shape from the origin of its frame, m.
[[nodiscard]] double bounding_radius(const Shape& shape) noexcept;

}  // namespace snug::geometry
