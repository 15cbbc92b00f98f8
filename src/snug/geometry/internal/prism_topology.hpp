// Prism numbering: which vertex, edge and face of the prism inside a cylinder has which index.
#pragma once

#include <array>

namespace snug::geometry::internal {

/// Sides of the prism that stands for the end of a cylinder where it lies on a face: the chord of a side is 0.5 % of
/// the radius inside the rim.
inline constexpr int kPrismSides = 32;

// Vertex i: lower rim, vertex kPrismSides + i: upper rim, counter-clockwise seen from above.
// Face 0: lower end, face 1: upper end, face 2 + i: between side edges i and i + 1.
// Edge i: side edge; kPrismSides + i: lower rim from i; 2 kPrismSides + i: upper rim from i.

/// Vertex loops of the ends, counter-clockwise from outside.
inline constexpr std::array<std::array<int, kPrismSides>, 2> kPrismEnds = [] {
  std::array<std::array<int, kPrismSides>, 2> ends{};
  for (int i = 0; i < kPrismSides; ++i) {
    ends[0][static_cast<std::size_t>(i)] = kPrismSides - 1 - i;
    ends[1][static_cast<std::size_t>(i)] = kPrismSides + i;
  }
  return ends;
}();

/// Vertex loops of the sides, counter-clockwise from outside.
inline constexpr std::array<std::array<int, 4>, kPrismSides> kPrismFaces = [] {
  std::array<std::array<int, 4>, kPrismSides> faces{};
  for (int i = 0; i < kPrismSides; ++i) {
    const int next = (i + 1) % kPrismSides;
    faces[static_cast<std::size_t>(i)] = {i, next, kPrismSides + next, kPrismSides + i};
  }
  return faces;
}();

/// Vertex, vertex, face, face of each edge.
inline constexpr std::array<std::array<int, 4>, 3 * kPrismSides> kPrismEdges = [] {
  std::array<std::array<int, 4>, 3 * kPrismSides> edges{};
  for (int i = 0; i < kPrismSides; ++i) {
    const int next = (i + 1) % kPrismSides;
    const int before = (i + kPrismSides - 1) % kPrismSides;
    edges[static_cast<std::size_t>(i)] = {i, kPrismSides + i, 2 + before, 2 + i};
    edges[static_cast<std::size_t>(kPrismSides + i)] = {i, next, 0, 2 + i};
    edges[static_cast<std::size_t>(2 * kPrismSides + i)] = {kPrismSides + i, kPrismSides + next, 1, 2 + i};
  }
  return edges;
}();

}  // namespace snug::geometry::internal
