// Seal: whether a lip that is told to grip finds a face of a box, and why not.
#pragma once

#include <string>

#include "snug/core/expected.hpp"
#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup {

/// A box face: 0 +x, 1 -x, 2 +y, 3 -y, 4 +z, 5 -z of the package.
using Face = int;

/// Outward unit normal of a face, in the package frame.
[[nodiscard]] Vector3 face_normal(Face face) noexcept;
/// "+x", "-x", ...
[[nodiscard]] const char* face_name(Face face) noexcept;

/// How the lip stands before the face that looks at it.
struct LipView {
  Face face = 4;
  Pose X_PS;              ///< lip laid on the face: origin where the cup axis meets it, z into the box, x as Ex
  double length = 0.0;    ///< m, E to the face along Ez
  double gap = 0.0;       ///< m, length - free length: negative when the lip is pressed
  double tilt = 0.0;      ///< rad, between Ez and the face's inward normal
  double overhang = 0.0;  ///< m, how far the lip stands over the nearest edge; negative inside
};

/// Looks along Ez at a box centred at P with half edge lengths `half`. Always answers; of two faces that look equally
/// at the gripper the first in the order of Face is taken.
[[nodiscard]] LipView look_at(const model::CupParams& params, const Pose& X_WE, const Vector3& half,
                              const Pose& X_WP) noexcept;

enum class NoSeal {
  OutOfReach,  ///< the lip ends before the face
  TooTilted,   ///< the lip plane is turned too far against the face
  OverEdge,    ///< part of the lip is not over the face
  WrongFace,   ///< the gripper's end is behind the face it looks at: no way to lay the lip on
};

struct Seal {
  Pose X_PS;
  Face face = 4;
  double length = 0.0;  ///< m, E to S at the moment of sealing
};

/// The reason, and the numbers it was decided on.
struct Refusal {
  NoSeal reason = NoSeal::OutOfReach;
  double gap = 0.0;       ///< m
  double tilt = 0.0;      ///< rad
  double overhang = 0.0;  ///< m
  bool operator==(const Refusal&) const = default;
};

[[nodiscard]] Expected<Seal, Refusal> try_seal(const model::CupParams& params, const Pose& X_WE, const Vector3& half,
                                               const Pose& X_WP) noexcept;

/// snake_case name: out_of_reach, too_tilted, over_edge, wrong_face.
[[nodiscard]] const char* name_of(NoSeal reason) noexcept;
/// One line with the numbers in mm and degrees, for event texts.
[[nodiscard]] std::string describe(const Refusal& refusal);

}  // namespace snug::cup
