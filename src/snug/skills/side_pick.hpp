// Side pick and set down: a face that looks sideways is picked and turned up in the air, so that a box need not be
// flipped.
#pragma once

#include "snug/skills/primitives.hpp"

namespace snug::skills {

/// A standing box, picked by a side face with the tool nearly level.
struct SidePickIntent {
  std::string box;                         ///< id
  Pose X_WP;                               ///< of the standing box; may be turned a little
  Vector3 size = Vector3::Constant(0.1);   ///< m
  Vector3 face = Vector3::UnitX();         ///< unit, level: about the outward normal of the side that is picked
  Vector3 cup_offset_P = Vector3::Zero();  ///< m, in P, from the middle of that face to where the cup presses
  double tool_yaw = 0.0;                   ///< rad, of the tool when it has turned the face up: R_WE = Rz(yaw) Ry(pi)
  double length = 0.072;                   ///< m, from E to the face when the vacuum comes on
  double approach_height = 0.2;            ///< m, z of E in W, before
  double lift = 0.2;                       ///< m, the box is lifted by this, still as it stood
  bool again = false;                      ///< as of PickIntent
  settings::SideGraspParams params;
};
/// Rows PrePick (high and upright, high and level, low before the face), Box, PostPick with vacuum: the box as it
/// stood, lifted. With `again`: PreRePick, RePick, PostRePick.
[[nodiscard]] std::vector<motion::Waypoint> side_pick_rows(const SidePickIntent& intent);
/// The tool at these rows.
struct SidePickPoses {
  Pose X_WE_high;    ///< level, before it comes low
  Pose X_WE_before;  ///< low, before the face
  Pose X_WE_pick;
  Pose X_WE_lifted;
};
[[nodiscard]] SidePickPoses side_pick_poses(const SidePickIntent& intent);
/// R_WE of a tool that points at `face`, and comes from above by `incline`; upright again it has `tool_yaw`.
[[nodiscard]] Matrix3 side_pick_rotation(const Vector3& face, double tool_yaw, double incline);
/// R_WP of the box when the face is up and the tool vertical.
[[nodiscard]] Matrix3 face_up(const Matrix3& R_WP, const Vector3& face);

/// A hanging box is put on a flat surface and let go.
struct SetDownIntent {
  std::string box;
  Pose X_WP;  ///< standing there
  Vector3 size = Vector3::Constant(0.1);
  double travel_bottom = 0.08;  ///< m, z in W of the lower face on the way in
  ToolFor tool_for;
  settings::SetDownParams params;
};
/// Rows PreTwist, Twist, Twist with vacuum off and blow-off on, PreTwist straight up.
[[nodiscard]] std::vector<motion::Waypoint> set_down_rows(const SetDownIntent& intent);

}  // namespace snug::skills
