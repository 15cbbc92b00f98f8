// CapsuleCapsule: the nearest points of the two segments, less both radii.
#include <cmath>

#include "snug/geometry/internal/capsule_capsule.hpp"
#include "snug/geometry/internal/segment.hpp"

namespace snug::geometry::internal {

namespace {

std::uint32_t name_on(double parameter, double length) noexcept {
  if (parameter * length < kSnap) return vertex_code(0);
  if ((1.0 - parameter) * length < kSnap) return vertex_code(1);
  return edge_code(0);
}

/// Direction for segments that meet: square to both, or to the first when they are parallel.
Vector3 direction_where_crossed(const Vector3& a, const Vector3& b) noexcept {
  const Vector3 cross = a.cross(b);
  if (cross.squaredNorm() > kParallelSquared) return cross.normalized();
  return a.unitOrthogonal();
}

}  // namespace

void collide_capsules(const Capsule& A, const Capsule& B, const PairCall& call, Manifold& out) noexcept {
  // Relative to A's centre, so that places far from the origin lose nothing.
  const Vector3 axis_A = call.X_WA.R.col(2);
  const Vector3 axis_B = call.X_WB.R.col(2);
  const Vector3 p_AB_W = call.X_WB.p - call.X_WA.p;
  const Vector3 a = A.half_length * axis_A;
  const Vector3 b = B.half_length * axis_B;
  const SegmentPair nearest = nearest_points(-a, a, p_AB_W - b, p_AB_W + b);
  const Vector3 difference = nearest.p_b - nearest.p_a;
  const double distance = difference.norm();
  const double phi = distance - A.radius - B.radius;
  if (!(phi <= call.margin)) return;
  // Below 1e-12 m the difference is rounding.
  const Vector3 n_W = distance > 1e-12 ? Vector3(difference / distance) : direction_where_crossed(axis_A, axis_B);
  const Vector3 p_WA = call.X_WA.p + nearest.p_a + A.radius * n_W;
  set_normal(call.swapped, n_W, out);
  emit(call.swapped, p_WA, p_WA + phi * n_W, phi, name_on(nearest.s, 2.0 * A.half_length),
       name_on(nearest.t, 2.0 * B.half_length), out);
}

}  // namespace snug::geometry::internal
