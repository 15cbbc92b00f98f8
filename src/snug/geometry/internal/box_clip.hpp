// BoxClip: the part of one box face that lies over a face of another box, with named corners.
#pragma once

#include <array>

#include "snug/geometry/internal/features.hpp"

namespace snug::geometry::internal {

/// A box face and another box, both in the frame of the first (the reference box).
struct BoxFacePair {
  Vector3 half_ref;
  Vector3 half_inc;
  Matrix3 R_RI;  ///< incident box in the reference frame
  Vector3 p_RI;
  int face = 0;                ///< of the reference box
  Vector3 n_R;                 ///< direction of projection, unit, out of the face
  bool name_ref_first = true;  ///< corners of the reference box win when corners of both boxes coincide
};

/// One corner of the clipped polygon: p_R on the reference face, p_R + phi n_R on the incident face.
struct BoxClipPoint {
  double u = 0.0;  ///< coordinates on the reference face along the next two axes, m
  double v = 0.0;
  double phi = 0.0;  ///< m, along n_R
  std::uint32_t code_ref = 0;
  std::uint32_t code_inc = 0;
};

/// Corners in no particular order.
struct BoxPolygon {
  int count = 0;
  double least_phi = 0.0;  ///< over all corners, m
  std::array<BoxClipPoint, 8> points;
};

/// Clips the face of the incident box that looks most against n_R by the sides of the reference face.
void clip_box_face(const BoxFacePair& pair, BoxPolygon& out) noexcept;

}  // namespace snug::geometry::internal
