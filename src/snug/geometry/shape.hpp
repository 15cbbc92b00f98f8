// Shapes that can touch: box, capsule, convex hull, cylinder.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::geometry {

/// Box centred at its frame, edges along the axes.
struct Box {
  Vector3 half = Vector3::Constant(0.5);  ///< half edge lengths, m, > 0
  bool operator==(const Box&) const = default;
};

/// Segment of length 2 half_length along z, centred, swept by a ball.
struct Capsule {
  double half_length = 0.5;  ///< m, >= 0
  double radius = 0.1;       ///< m, > 0
  bool operator==(const Capsule&) const = default;
};

/// Closed convex polyhedron. Built by make_convex_hull, which fills the derived parts.
struct ConvexHull {
  std::vector<Vector3> vertices;          ///< m
  std::vector<std::vector<int>> faces;    ///< vertex loops, counter-clockwise from outside
  std::vector<Vector3> normals;           ///< outward unit normal of each face
  std::vector<std::array<int, 4>> edges;  ///< vertex, vertex, face, face; each edge once
  bool operator==(const ConvexHull&) const = default;
};

/// Solid cylinder along z, centred, with flat ends.
struct Cylinder {
  double half_length = 0.5;  ///< m, > 0
  double radius = 0.1;       ///< m, > 0
  bool operator==(const Cylinder&) const = default;
};

using Shape = std::variant<Box, Capsule, ConvexHull, Cylinder>;

}  // namespace snug::geometry
