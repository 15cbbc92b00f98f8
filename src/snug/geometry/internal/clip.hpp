// Clip: the part of one face (or segment) that lies over a face of another polytope, with named corners.
#pragma once

#include "snug/geometry/internal/features.hpp"
#include "snug/geometry/internal/polytope.hpp"

namespace snug::geometry::internal {

struct ClipPoint {
  Vector3 p_ref;     ///< on the reference face; p_ref + phi n lies on the incident one
  double phi = 0.0;  ///< m, along n
  std::uint32_t code_ref = 0;
  std::uint32_t code_inc = 0;
};

inline constexpr std::size_t kMaxCorners = 2 * kMaxHullVertices + 4;

struct ClipPolygon {
  int count = 0;
  double least_phi = 0.0;  ///< m
  std::array<ClipPoint, kMaxCorners> points;
};

/// What is projected on what.
struct ClipTask {
  const Polytope& ref;
  int face;                    ///< of ref
  const Polytope& inc;         ///< its face most against n is taken, or the segment it is
  Vector3 n;                   ///< unit, out of the face; the direction of projection
  bool name_ref_first = true;  ///< corners of ref win the name where corners of both coincide
};

void clip_faces(const ClipTask& task, ClipPolygon& out) noexcept;

/// Drops points above `margin`, then thins the rest to kMaxManifoldPoints: the deepest stays, and of the others
/// those whose triangle with their neighbours is largest.
void reduce(double margin, ClipPolygon& polygon) noexcept;

}  // namespace snug::geometry::internal
