// Tolerances of the narrow phase, in one place: each bounds an error that README.md states.
#pragma once

#include <limits>

namespace snug::geometry::internal {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The reported depth may exceed the least one by this [m] plus kBiasRelative of it, to keep face contacts faces (half
/// of it, from scratch) and to keep the axis of the last call (all of it). The same bounds a reported distance, without
/// the relative part.
inline constexpr double kBias = 1e-6;
inline constexpr double kBiasRelative = 1e-3;
/// Overlap or gap [m] across a second face axis below which a pair is a corner pair (README.md, "Seams").
/// 20 um of geometry plus rounding of poses; well below anything a box is made to.
inline constexpr double kCornerSlop = 21e-6;
/// Largest |cosine| between the two axes of a corner pair.
inline constexpr double kCornerCosine = 0.3;
/// Two clipped points closer than this [m] are one.
inline constexpr double kMerge = 1e-6;
/// A clipped point closer than this [m] to a vertex is named after the vertex.
inline constexpr double kSnap = 1e-5;
/// sin^2 of the angle between two edges below which their cross product is no axis. Skipping it costs at most
/// 2e-7 times the size of the shape in depth.
inline constexpr double kParallelSquared = 1e-14;
/// A face within this cosine of an edge-edge normal: the contact keeps the polygon over the face.
inline constexpr double kNearFaceCosine = 0.99;
/// Parallel edges that meet with faces on either side (README.md, "How an answer is found"): largest and least cosine
/// between the normals of the two faces, sin^2 of the angle between the edges, and how far [m] they miss each other.
inline constexpr double kSameNormal = 0.9994, kOppositeEdges = 0.1;
inline constexpr double kEdgesParallelSquared = 1e-8;
inline constexpr double kEdgeMiss = 2e-6;
/// Features meet across an axis when their points miss each other by less than this [m], sideways.
inline constexpr double kMiss = 1e-9;
/// Axes whose separations differ by less [m] are tied and the first one wins.
inline constexpr double kTie = 1e-12;
/// Distances that differ by less [m] are tied. Smaller, because a distance hardly feels the direction: 1e-15 m at
/// 1 mm is 1e-6 rad.
inline constexpr double kDistanceTie = 1e-15;

}  // namespace snug::geometry::internal
