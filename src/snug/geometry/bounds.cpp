// bounds: support of each shape along the world axes.
#include "snug/geometry/bounds.hpp"

#include <algorithm>
#include <cmath>

namespace snug::geometry {

namespace {

Aabb bounds_of(const Box& box, const Pose& X_WG) noexcept {
  const Vector3 reach = X_WG.R.cwiseAbs() * box.half;
  return {X_WG.p - reach, X_WG.p + reach};
}

Aabb bounds_of(const Capsule& capsule, const Pose& X_WG) noexcept {
  const Vector3 reach = X_WG.R.col(2).cwiseAbs() * capsule.half_length + Vector3::Constant(capsule.radius);
  return {X_WG.p - reach, X_WG.p + reach};
}

Aabb bounds_of(const Cylinder& cylinder, const Pose& X_WG) noexcept {
  const Vector3 reach = half_extent(cylinder, X_WG.R);
  return {X_WG.p - reach, X_WG.p + reach};
}

Aabb bounds_of(const ConvexHull& hull, const Pose& X_WG) noexcept {
  if (hull.vertices.empty()) return {X_WG.p, X_WG.p};
  Aabb box{X_WG * hull.vertices.front(), X_WG * hull.vertices.front()};
  for (const Vector3& p_GV : hull.vertices) {
    const Vector3 p_WV = X_WG * p_GV;
    box.lower = box.lower.cwiseMin(p_WV);
    box.upper = box.upper.cwiseMax(p_WV);
  }
  return box;
}

}  // namespace

Vector3 half_extent(const Cylinder& cylinder, const Matrix3& R_WG) noexcept {
  const Vector3 along = R_WG.col(2).cwiseAbs();
  // A disc square to z reaches r sin(angle) along an axis at that angle from z.
  const Vector3 across = (Vector3::Ones() - along.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return cylinder.half_length * along + cylinder.radius * across;
}

double bounding_radius(const Shape& shape) noexcept {
  if (const Box* box = std::get_if<Box>(&shape)) return box->half.norm();
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return capsule->half_length + capsule->radius;
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape))
    return std::hypot(cylinder->half_length, cylinder->radius);
  double radius = 0.0;
  for (const Vector3& p_GV : std::get_if<ConvexHull>(&shape)->vertices) radius = std::max(radius, p_GV.norm());
  return radius;
}

Aabb bounds(const Shape& shape, const Pose& X_WG) noexcept {
  if (const Box* box = std::get_if<Box>(&shape)) return bounds_of(*box, X_WG);
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return bounds_of(*capsule, X_WG);
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape)) return bounds_of(*cylinder, X_WG);
  return bounds_of(*std::get_if<ConvexHull>(&shape), X_WG);
}

}  // namespace snug::geometry
