// Segment: nearest points of two line segments.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::geometry::internal {

struct SegmentPair {
  double s = 0.0;  ///< along the first, 0..1
  double t = 0.0;  ///< along the second, 0..1
  Vector3 p_a;
  Vector3 p_b;
};

/// Nearest points of a0-a1 and b0-b1. For parallel segments the middle of the part where they are nearest.
[[nodiscard]] SegmentPair nearest_points(const Vector3& a0, const Vector3& a1, const Vector3& b0,
                                         const Vector3& b1) noexcept;

/// Where edges a and b cross when b is moved back by `offset`, which is along the common normal; clamped to the edges.
[[nodiscard]] SegmentPair crossing_points(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1,
                                          const Vector3& offset) noexcept;

}  // namespace snug::geometry::internal
