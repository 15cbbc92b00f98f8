// Manifold: where two shapes touch or are about to, with names that last from one step to the next.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "snug/geometry/shape.hpp"

namespace snug::geometry {

inline constexpr int kMaxManifoldPoints = 8;

/// One pair of nearest points of A and B.
struct ManifoldPoint {
  Vector3 p_WA = Vector3::Zero();  ///< on (or in) A, m, world
  Vector3 p_WB = Vector3::Zero();  ///< on (or in) B, m, world
  double phi = 0.0;                ///< n_AB_W . (p_WB - p_WA), m, negative when they overlap
  std::uint32_t feature = 0;       ///< which features of A and B meet; equal in successive calls for the same contact
};

/// All points share one normal. Empty when the shapes are farther apart than the margin.
struct Manifold {
  Vector3 n_AB_W = Vector3::UnitZ();  ///< unit, from A to B
  int count = 0;
  std::array<ManifoldPoint, kMaxManifoldPoints> points;
  /// m^2, of the rectangle along one of the two faces that holds the region where they overlap, within the margin or
  /// not; 0 where edges or corners of boxes meet. Known for two boxes; other shapes: infinite.
  double face_area = std::numeric_limits<double>::infinity();
  /// Within the margin, without points although: seen alone, what is flush there would be a wall (README.md, "Seams").
  bool is_corner_pair = false;
};

/// What a pair remembers between calls: the features that separated it last. Only saves time and breaks ties.
struct PairCache {
  std::uint32_t features = 0;  ///< 0: nothing known
  bool operator==(const PairCache&) const = default;
};

/// Contact manifold of two convex shapes.
///
/// Points with phi <= margin are returned. Face contacts keep their whole clipped polygon (reduced to
/// kMaxManifoldPoints keeping the deepest and the largest area when a hull has more). The normal is the direction of
/// least penetration when the shapes overlap, and of least distance when they do not.
void collide(const Shape& A, const Pose& X_WA, const Shape& B, const Pose& X_WB, double margin, PairCache& cache,
             Manifold& out) noexcept;

}  // namespace snug::geometry
