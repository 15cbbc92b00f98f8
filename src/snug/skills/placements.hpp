// program_from_placements: plain pick-and-place waypoints for boxes that need no flip.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/core/expected.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::skills {

/// One box as it stands at the aligner.
struct PickSpec {
  std::string box;                        ///< id; the part after a leading "BOX" names its waypoints
  Pose X_WP;                              ///< at the aligner; an axis of P must be vertical
  Vector3 size = Vector3::Constant(0.1);  ///< m, along Px, Py, Pz
  Vector3 cup_offset = Vector3::Zero();   ///< m, in P: from the middle of the top face to where the cup presses
  std::optional<double> tool_yaw;         ///< rad, at the pick; absent: PlacementSettings::tool_yaw
};

struct Placement {
  std::string box;  ///< id of a PickSpec
  Pose X_TP;        ///< where it shall rest in the container
};

/// Heights in W along z, which is up.
struct PlacementSettings {
  Pose X_WT;                       ///< container
  double rim_height = 0.25;        ///< m, z of the container's rim in T
  double obstacle_top = -1.0e9;    ///< m, z in W of the highest fixed thing between aligner and container
  double pick_length = 0.050;      ///< m, from E to the top face when pressing
  double hold_length = 0.055;      ///< m, from E to the top face while the box hangs
  double free_length = 0.070;      ///< m, from E to the lip of the cup that holds nothing
  double release_gap = 0.0;        ///< m, below the box when it is let go
  double travel_clearance = 0.06;  ///< m, under box or cup when crossing; above the precision of fly-by rows (0.05)
  /// m, above rim and packed boxes: height of a stop (PrePlaceNNN_2) where the tool settles sideways before it goes
  /// down between them; absent: no such stop.
  std::optional<double> entry_clearance = 0.01;
  double tool_yaw = 0.0;  ///< rad, R_WE = Rz(yaw) Ry(pi) at the pick
  Pose X_WE_home;         ///< last row
};

enum class NoProgram { UnknownBox, PlacedTwice, NotUpright, NeedsFlip, TiltedPlacement, BadNumber };
[[nodiscard]] const char* describe(NoProgram reason);

struct NoProgramReason {
  NoProgram reason = NoProgram::UnknownBox;
  std::string box;
  std::string text;  ///< one line for people
};

/// Rows PrePick, Box, PostPick (vacuum on), PrePlace, [PrePlace_2,] Place, Place (vacuum off, blow-off on), PostPlace
/// for each placement in order, then home. Picks and places are vertical;
/// crossings are above the rim, `obstacle_top`, the boxes placed before and the box to be picked.
[[nodiscard]] Expected<motion::Program, NoProgramReason> program_from_placements(std::span<const PickSpec> picks,
                                                                                 std::span<const Placement> placements,
                                                                                 const PlacementSettings& settings);

}  // namespace snug::skills
