// bounds: support of each shape along the world axes.
#include "snug/geometry/bounds.hpp"

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

Aabb bounds(const Shape& shape, const Pose& X_WG) noexcept {
  if (const Box* box = std::get_if<Box>(&shape)) return bounds_of(*box, X_WG);
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return bounds_of(*capsule, X_WG);
  return bounds_of(*std::get_if<ConvexHull>(&shape), X_WG);
}

}  // namespace snug::geometry
