// Box numbering: which vertex, edge and face of a box has which index.
#pragma once

#include <array>

namespace snug::geometry::internal {

// Vertex v: bit k set when coordinate k is positive.
// Face f = 2 axis + (1 when positive).
// Edge e = 4 axis + bit 0 (coordinate axis+1 positive) + bit 1 (coordinate axis+2 positive).

constexpr int next(int axis) { return axis == 2 ? 0 : axis + 1; }
constexpr int box_face(int axis, bool positive) { return 2 * axis + (positive ? 1 : 0); }
constexpr int box_edge(int axis, bool next_positive, bool after_positive) {
  return 4 * axis + (next_positive ? 1 : 0) + (after_positive ? 2 : 0);
}
constexpr int box_vertex(int axis, bool positive, bool next_positive, bool after_positive) {
  const int n = next(axis);
  return (positive ? 1 << axis : 0) | (next_positive ? 1 << n : 0) | (after_positive ? 1 << next(n) : 0);
}

/// Vertex loops of the faces, counter-clockwise from outside.
inline constexpr std::array<std::array<int, 4>, 6> kBoxFaces = [] {
  std::array<std::array<int, 4>, 6> faces{};
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool positive : {false, true}) {
      const std::array<int, 4> loop = {box_vertex(axis, positive, false, false),
                                       box_vertex(axis, positive, true, false), box_vertex(axis, positive, true, true),
                                       box_vertex(axis, positive, false, true)};
      for (std::size_t i = 0; i < 4; ++i) {
        faces[static_cast<std::size_t>(box_face(axis, positive))][i] = positive ? loop[i] : loop[3 - i];
      }
    }
  }
  return faces;
}();

/// Vertex, vertex, face, face of each edge.
inline constexpr std::array<std::array<int, 4>, 12> kBoxEdges = [] {
  std::array<std::array<int, 4>, 12> edges{};
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool n : {false, true}) {
      for (const bool a : {false, true}) {
        edges[static_cast<std::size_t>(box_edge(axis, n, a))] = {box_vertex(axis, false, n, a),
                                                                 box_vertex(axis, true, n, a), box_face(next(axis), n),
                                                                 box_face(next(next(axis)), a)};
      }
    }
  }
  return edges;
}();

}  // namespace snug::geometry::internal
