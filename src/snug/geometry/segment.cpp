// Segment: nearest points of two line segments, after Ericson, Real-Time Collision Detection, section 5.1.9.
#include <algorithm>

#include "snug/geometry/internal/segment.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

double clamp01(double x) noexcept { return std::clamp(x, 0.0, 1.0); }

/// Middle of the stretch of a over which b lies, for segments that run side by side.
double middle_of_overlap(double a, double b, double c) noexcept {
  // Parameters on the first segment of both ends of the second: ends project to (-c)/a and (b - c)/a.
  const double at_b0 = -c / a;
  const double at_b1 = (b - c) / a;
  return 0.5 * (clamp01(std::min(at_b0, at_b1)) + clamp01(std::max(at_b0, at_b1)));
}

}  // namespace

SegmentPair nearest_points(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1) noexcept {
  const Vector3 d1 = a1 - a0;
  const Vector3 d2 = b1 - b0;
  const Vector3 r = a0 - b0;
  const double a = d1.squaredNorm();
  const double e = d2.squaredNorm();
  const double f = d2.dot(r);
  const double c = d1.dot(r);
  SegmentPair pair;
  if (a > 0.0 && e > 0.0) {
    const double b = d1.dot(d2);
    const double cross_squared = d1.cross(d2).squaredNorm();
    pair.s = cross_squared > kParallelSquared * a * e ? clamp01((b * f - c * e) / cross_squared)
                                                      : middle_of_overlap(a, b, c);
    pair.t = (b * pair.s + f) / e;
    if (!(pair.t >= 0.0 && pair.t <= 1.0)) {
      pair.t = clamp01(pair.t);
      pair.s = clamp01((b * pair.t - c) / a);
    }
  } else if (a > 0.0) {
    pair.s = clamp01(-c / a);
  } else if (e > 0.0) {
    pair.t = clamp01(f / e);
  }
  pair.p_a = a0 + pair.s * d1;
  pair.p_b = b0 + pair.t * d2;
  return pair;
}

SegmentPair crossing_points(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1,
                            const Vector3& offset) noexcept {
  const Vector3 d1 = a1 - a0;
  const Vector3 d2 = b1 - b0;
  const Vector3 r = a0 - b0;
  const Vector3 n = d1.cross(d2);
  const double n_squared = n.squaredNorm();
  SegmentPair pair;
  if (!(n_squared > 0.0)) return nearest_points(a0, a1, b0, b1);
  pair.s = clamp01(d2.cross(r).dot(n) / n_squared);
  pair.p_a = a0 + pair.s * d1;
  // From the point, not from the other formula: nearly parallel edges then still give points that face each other.
  pair.t = clamp01(d2.dot(pair.p_a + offset - b0) / d2.squaredNorm());
  pair.p_b = b0 + pair.t * d2;
  return pair;
}

}  // namespace snug::geometry::internal
