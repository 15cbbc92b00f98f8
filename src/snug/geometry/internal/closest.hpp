// Closest: the nearest features of two polytopes that do not overlap.
#pragma once

#include "snug/geometry/internal/features.hpp"
#include "snug/geometry/internal/polytope.hpp"

namespace snug::geometry::internal {

struct Closest {
  double distance = 0.0;  ///< m
  Vector3 n;              ///< unit, from A to B
  Vector3 p_A;
  Vector3 p_B;
  std::uint32_t code_A = 0;
  std::uint32_t code_B = 0;
};

/// Exact distance of two separated polytopes when it is at most `limit`; false when it is more.
/// `n` is a unit direction along which they are separated: only features within reach of its two planes are compared.
[[nodiscard]] bool find_closest(const Polytope& A, const Polytope& B, const Vector3& n, double limit,
                                Closest& out) noexcept;

}  // namespace snug::geometry::internal
