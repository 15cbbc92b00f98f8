// CylinderPair: contact manifold of a cylinder with a polytope, the core of a capsule, or another cylinder.
#pragma once

#include "snug/geometry/internal/features.hpp"
#include "snug/geometry/internal/polytope.hpp"

namespace snug::geometry::internal {

/// A: a polytope in the frame of its pose, or a segment or point with `radius` around it. B: a cylinder.
void collide_polytope_cylinder(const Polytope& A, double radius, const Cylinder& B, const Pose& X_AB,
                               const PairCall& call, Axis& axis, Manifold& out) noexcept;

void collide_cylinders(const Cylinder& A, const Cylinder& B, const Pose& X_AB, const PairCall& call,
                       Manifold& out) noexcept;

}  // namespace snug::geometry::internal
