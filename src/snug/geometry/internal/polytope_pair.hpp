// PolytopePair: contact manifold of any two polytopes, the second perhaps the core of a capsule.
#pragma once

#include "snug/geometry/internal/features.hpp"
#include "snug/geometry/internal/polytope.hpp"

namespace snug::geometry::internal {

/// Two polytopes in the frame of A's pose. B may be a segment with `radius` around it, A not.
struct PolytopePair {
  const Polytope& A;
  const Polytope& B;
  double radius = 0.0;  ///< m
};

void collide_polytopes(const PolytopePair& pair, const PairCall& call, Axis& axis, Manifold& out) noexcept;

/// Contact of two boxes that are apart and whose nearest features are not a pair of faces. n_A is the axis that
/// separates them most.
void collide_apart(const Box& A, const Box& B, const Matrix3& R_AB, const Vector3& p_AB, const Vector3& n_A,
                   const PairCall& call, Manifold& out) noexcept;

}  // namespace snug::geometry::internal
