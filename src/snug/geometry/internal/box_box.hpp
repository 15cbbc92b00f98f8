// BoxBox: contact manifold of two boxes, the pair that matters for speed.
#pragma once

#include "snug/geometry/internal/features.hpp"

namespace snug::geometry::internal {

/// Adds the contact of two boxes to `out` (which comes with count 0); `axis` is what the pair remembers.
void collide_boxes(const Box& A, const Box& B, const PairCall& call, Axis& axis, Manifold& out) noexcept;

}  // namespace snug::geometry::internal
