// CapsuleCapsule: contact of two capsules.
#pragma once

#include "snug/geometry/internal/features.hpp"

namespace snug::geometry::internal {

void collide_capsules(const Capsule& A, const Capsule& B, const PairCall& call, Manifold& out) noexcept;

}  // namespace snug::geometry::internal
