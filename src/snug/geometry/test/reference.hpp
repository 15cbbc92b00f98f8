// Reference: the slow second opinion. Extended precision, every axis, every pair of features, no shortcuts.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "snug/geometry/manifold.hpp"

namespace snug::geometry::test {

/// Three long doubles; nothing of the code under test.
struct Point {
  long double x = 0, y = 0, z = 0;
};

/// A shape in the world as points, planes and lines, with a radius around it.
struct Solid {
  std::vector<Point> vertices;
  std::vector<Point> face_normals;      ///< outward, unit
  std::vector<std::vector<int>> faces;  ///< counter-clockwise
  std::vector<std::array<int, 2>> edges;
  std::vector<Point> edge_directions;  ///< unit; parallel ones once
  long double radius = 0;
};

[[nodiscard]] Solid place(const Shape& shape, const Pose& X_WG);

/// What is true of a pair.
struct Truth {
  bool overlap = false;        ///< of the cores
  long double separation = 0;  ///< minus the least penetration, or the Euclidean distance, radii taken off
  bool beyond = false;         ///< farther than the limit; separation is then a lower bound
  bool may_be_corner = false;  ///< README.md, "Seams", holds for an axis as good as the best
};

[[nodiscard]] Truth find_truth(const Solid& A, const Solid& B, long double limit);

/// What lies between the support planes of A and B square to n, radii taken off.
[[nodiscard]] long double separation_along(const Solid& A, const Solid& B, const Vector3& n);

/// Distance of p from the surface of the solid: negative inside.
[[nodiscard]] long double height_above(const Solid& solid, const Vector3& p);

}  // namespace snug::geometry::test
