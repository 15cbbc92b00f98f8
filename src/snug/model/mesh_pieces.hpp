// Surfaces of triangles: what they enclose, and the loose pieces that they consist of.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "snug/geometry/convex_hull.hpp"

namespace snug::model {

/// A surface in the file's own axes. Corners at equal positions are one corner, whether or not they share an index.
struct MeshPart {
  std::vector<Vector3> points;                ///< m; also such as no triangle has
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise from outside, if the file has them so
};

struct SurfaceMeasures {
  double volume = 0.0;  ///< m^3 enclosed, by the divergence theorem; negative: triangles face inwards. 0 if not closed
  double area = 0.0;    ///< m^2
  bool is_closed = false;  ///< every edge as often in one direction as in the other
};
[[nodiscard]] SurfaceMeasures measure_surface(const MeshPart& part);
[[nodiscard]] SurfaceMeasures measure_surface(const geometry::ConvexHull& hull);

/// The closed pieces of a surface, triangles wound alike, in the order of their first triangles: what meets only in
/// corners, or in edges of more than two triangles, is apart. The surface itself, unchanged, where a piece is not
/// closed or spans no volume, or where there are more than `most`. Cavities, closed surfaces inside another that face
/// the other way, are no pieces.
[[nodiscard]] std::vector<MeshPart> split_loose_pieces(const MeshPart& part, std::size_t most);

}  // namespace snug::model
