// Primitives: pick, flip and place as waypoints with switches, from what shall happen to the box.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/motion/waypoint.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::skills {

/// The pose of the tool with which the box, hanging still from the cup, stands as asked (the cup's sag made up for).
using ToolFor = std::function<Pose(const Pose& X_WP)>;

/// Box as it stands, tool above it. Rows approach, press, lift with vacuum.
struct PickIntent {
  std::string box;                         ///< id
  Pose X_WP;                               ///< of the standing box; may be turned and tilted a little
  Vector3 size = Vector3::Constant(0.1);   ///< m, along Px, Py, Pz
  Vector3 cup_offset_P = Vector3::Zero();  ///< m, in P, from the middle of the upper face to where the cup presses
  double tool_yaw = 0.0;                   ///< rad, R_WE = Rz(yaw) Ry(pi)
  double length = 0.058;                   ///< m, from E to the face when pressing
  double approach_height = 0.2;            ///< m, z of E in W, before
  double lift_height = 0.3;                ///< m, z of E in W, after
  bool again = false;                      ///< the box was set down before: names PreRePick, RePick, PostRePick
  double slow_lift = 0.0;                  ///< m, of the lift that is a row of its own, `_off`; 0: none
};
[[nodiscard]] std::vector<motion::Waypoint> pick_rows(const PickIntent& intent);

/// Box as it leans: the tool square to its uppermost face, the box drawn off along that face's normal by `leaning_lift`
/// m, then level above.
[[nodiscard]] std::vector<motion::Waypoint> leaning_pick_rows(const PickIntent& intent, double leaning_lift);
/// The least turn that brings the uppermost face of a box level.
[[nodiscard]] Matrix3 leveling(const Matrix3& R_WP);

/// The tool on the box, pressed.
[[nodiscard]] Pose tool_on_face(const PickIntent& intent);

/// Where on the upper face the cup should press, in P from the middle of that face: over the centre of mass, as far as
/// a disc of `lip_radius` stays on the face.
[[nodiscard]] Vector3 choose_cup_offset(const Matrix3& R_WP, const Vector3& size, const Vector3& com_P,
                                        double lip_radius);

/// Turn of a hanging box about its lower edge over a flat surface until the side that faced against `direction` is
/// its lower face (report Figure 13), let go, tool drawn back and up.
struct FlipIntent {
  std::string box;
  Matrix3 R_WP = Matrix3::Identity();     ///< of the hanging box before, standing on a face
  Vector3 size = Vector3::Constant(0.1);  ///< m
  Vector3 p_WF = Vector3::Zero();         ///< m, on the surface: under the middle of the box when it lies
  Vector3 direction = Vector3::UnitX();   ///< unit, level: where the tool points at the end
  double travel_bottom = 0.08;            ///< m, z in W of the lower edge on the way in
  Pose X_PE;                              ///< tool on the box, the cup not deformed
  ToolFor tool_for;
  settings::PivotParams params;
};
[[nodiscard]] std::vector<motion::Waypoint> flip_rows(const FlipIntent& intent);
/// R_WP of the box that lies after this flip.
[[nodiscard]] Matrix3 flipped(const Matrix3& R_WP, const Vector3& direction);

/// A tight slot: the box enters tilted and is levelled while it is pushed.
struct TiltedEntry {
  Vector3 low_side = Vector3::UnitX();  ///< unit, level: the side that goes in first
  Vector3 push = Vector3::Zero();       ///< m, level: how far the box is pushed beyond its place while it is levelled
  double edge_height = 0.0;             ///< m, z in W of the upper edge of the slot
};

/// m, z of E over a place.
struct ToolHeights {
  double travel = 0.3;          ///< where it crosses over things
  std::optional<double> entry;  ///< where it stops before it goes down; none: nowhere
  double leave = 0.3;           ///< after
};

/// A box that hangs from the cup comes to rest in the container.
struct PlaceIntent {
  std::string box;
  Pose X_WP;                              ///< at rest, level
  Vector3 size = Vector3::Constant(0.1);  ///< m
  ToolFor tool_for;
  double travel_bottom = 0.1;            ///< m, z in W of the lower face when it crosses over things
  double entry_bottom = 0.0;             ///< m, z of the lower face where it stops before it goes down
  Vector3 come_from = Vector3::Zero();   ///< m, level: shift of the box on its way down, away from its neighbours
  Vector3 overtravel = Vector3::Zero();  ///< m, level: how far it is pushed beyond its place, against neighbours
  settings::InsertionParams params;
  std::optional<TiltedEntry> tilted;
  /// Given in the place of travel_bottom and entry_bottom, and of where the tool leaves to.
  std::optional<ToolHeights> tool_heights;
  bool gentle = false;  ///< slow rows (PlaceSlow) instead of quick ones
  /// m, of the tool below where the box would just touch its support hanging, while it is pushed and let go: so far
  /// that the support carries it. None: it is pushed while it hangs.
  std::optional<double> lowered;
  /// rad, the tool leans about its lip while it pushes and until it lets go, so that the lower edge of the box leads.
  /// Upright, it would pull the upper edge ahead: the neighbour's force acts below the cup and turns the box.
  double push_lean = 0.0;
  double lip = 0.055;  ///< m, from E to the lip of the cup that holds the box
};
/// Rows PrePlace, PrePlace_2, Place ..., Place with vacuum off and blow-off on, PostPlace straight up.
[[nodiscard]] std::vector<motion::Waypoint> place_rows(const PlaceIntent& intent);

/// The tool at the first of these rows.
[[nodiscard]] Pose tool_over_place(const PlaceIntent& intent);

/// z of the lowest corner of a box relative to its middle (negative).
[[nodiscard]] double lowest_corner(const Matrix3& R_WP, const Vector3& size);

}  // namespace snug::skills
