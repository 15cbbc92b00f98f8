// make_convex_hull: a polyhedron with merged flat faces from a cloud of points.
#pragma once

#include <span>

#include "snug/core/expected.hpp"
#include "snug/geometry/shape.hpp"

namespace snug::geometry {

/// Limits of a hull that can collide: its scratch lives on the stack.
inline constexpr int kMaxHullVertices = 64;
inline constexpr int kMaxHullFaces = 124;
inline constexpr int kMaxHullEdges = 186;

enum class NoHull {
  NotFinite,       ///< a coordinate is NaN or infinite
  TooFewPoints,    ///< fewer than four distinct points
  Flat,            ///< all points within 1e-6 of the cloud's size of one plane
  TooManyVertices  ///< more than kMaxHullVertices corners are left
};

/// Convex hull of points in the shape's frame [m]. Points closer to each other, faces closer to one plane and corners
/// closer to a straight line than 1e-7 of the cloud's size are merged, so a cloud of a box gives 8 vertices and 6
/// faces. Order of the result depends on the order of the points only.
[[nodiscard]] Expected<ConvexHull, NoHull> make_convex_hull(std::span<const Vector3> points);

}  // namespace snug::geometry
