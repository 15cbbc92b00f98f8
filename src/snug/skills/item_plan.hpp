// ItemPlan: from a box and the place it shall have to the rows that bring it there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/ids.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/skills/cell_layout.hpp"
#include "snug/skills/insertion.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/side_pick.hpp"

namespace snug::skills {

/// How another face of a box is brought up.
enum class Reorientation {
  None,       ///< it is up already
  SideGrasp,  ///< picked by that face
  Regrasp,    ///< put on a flat surface, then picked by that face
  Pivot,      ///< turned over its lower edge on a flat surface, let go, picked again (report Figure 13)
};
[[nodiscard]] const char* name_of(Reorientation reorientation);

/// A box of the plan: as the scenario has it.
struct PlannedBox {
  model::ItemIndex item;
  std::string id;
  Vector3 size = Vector3::Constant(0.1);  ///< m, collision size
  SpatialInertia inertia;
};
[[nodiscard]] PlannedBox make_planned_box(const model::Scenario& scenario, const model::Sequence& sequence,
                                          model::ItemIndex item);
/// m, in P, from the middle of the upper face to where the cup presses: as near the centre of mass as it seals.
[[nodiscard]] Vector3 cup_offset(const model::CupParams& cup, double seal_margin, const PlannedBox& box,
                                 const Matrix3& R_WP);

/// Where a pick from above begins.
enum class PickKind {
  First,      ///< at the aligner
  FromAfar,   ///< of a box that was let go before, the tool somewhere else
  FromAbove,  ///< of a box that was just let go, the tool still over it
};
/// rad, about the vertical, that a box is turned by on its way from X_WP to X_WP_next: the shorter way round, or, with
/// `layout.is_fast`, the one that differs less from the turn of the robot's first axis.
[[nodiscard]] double turn_between(const CellLayout& layout, const Pose& X_WP, const Pose& X_WP_next);
/// Rows that pick the box where it stands, so that it can be brought to X_WP_next next (of the place the direction
/// from the robot counts). The turn between both is shared: at the pick the tool is turned from `layout.neutral_yaw` to
/// one side by half of it, then to the other.
[[nodiscard]] std::vector<motion::Waypoint> plan_pick(const model::Scenario& scenario, const CellLayout& layout,
                                                      const PlannedBox& box, const Pose& X_WP, const Pose& X_WP_next,
                                                      double travel_bottom, PickKind kind);
/// The same of a box that leans: leaning_pick_rows.
[[nodiscard]] std::vector<motion::Waypoint> plan_leaning_pick(const model::Scenario& scenario, const CellLayout& layout,
                                                              const PlannedBox& box, const Pose& X_WP,
                                                              const Pose& X_WP_next, double travel_bottom);
/// Where the tool waits for a box that will stand at the aligner like X_WP and whose place is not yet known: over it,
/// at the neutral yaw.
[[nodiscard]] Pose tool_before_pick(const model::Scenario& scenario, const CellLayout& layout, const PlannedBox& box,
                                    const Pose& X_WP, double travel_bottom);
/// How many times its weight the cup could carry of the box that hangs still, by the face by which it carries most.
[[nodiscard]] double still_hold_factor(const model::Scenario& scenario, const PlannedBox& box);
/// Whether the cup still holds the box below that face as often as PlaceLimits::hold_factor asks, and a fourth more,
/// when a push that ends by what is felt (motion::FastSettings) has taken from the hold what ends it.
[[nodiscard]] bool may_push_hanging(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P);
/// Fraction of the tempo, 0.2 to 1 in steps of 0.05, at which the cup holds the box below that face as often as
/// PlaceLimits::hold_factor asks, and a twentieth more (a fourth where it may not be pushed hanging), while the gripper
/// has the accelerations of motion::FastSettings (they go with the square), in the lift twice that: its end is a step
/// for such a box. 0.2 also where it would not hold it then.
[[nodiscard]] double pace_of(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P);
/// Of the box that hangs from the face that looks along `up_P` (P axis), within TravelParams, at its pace.
[[nodiscard]] motion::Swing swing_of(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P);
/// The rows with others in between, so that the wrist does not wind up and the tool keeps away from the robot's base.
/// `swing`: of what hangs on the way: fast motions are told. None: not known, or nothing does.
[[nodiscard]] std::vector<motion::Waypoint> drivable(const CellLayout& layout, const motion::Waypoint& before,
                                                     const std::vector<motion::Waypoint>& rows,
                                                     const std::optional<motion::Swing>& swing = std::nullopt);
/// Rows of a fast motion: where a box was let go the tool leaves it slowly, blowing, until the lip is off it. Faster
/// the bellows would draw in air and lift the box.
[[nodiscard]] std::vector<motion::Waypoint> with_detaching(const CellLayout& layout,
                                                           const std::vector<motion::Waypoint>& rows);
/// Orientation in which a standing box is carried to a flip that turns the P axis `up_P` upward.
[[nodiscard]] Matrix3 orientation_before_flip(const Matrix3& R_WP, const Vector3& up_P, const Vector3& direction);

/// Rows that pick the box by the side that looks along `face` (unit, level, in W) and lift it as it stood; `again`: it
/// was set down before. Empty where the cup would touch what the box stands on or reach too far over its upper edge.
/// Fast: so high that it passes over everything on the way to X_WP_next, on which that side may turn up.
[[nodiscard]] std::vector<motion::Waypoint> plan_side_pick(const model::Scenario& scenario, const CellLayout& layout,
                                                           const PlannedBox& box, const Pose& X_WP, const Vector3& face,
                                                           const Pose& X_WP_next, double travel_bottom, bool again);
/// Row that turns that side up, in the air.
[[nodiscard]] motion::Waypoint plan_turn_up(const model::Scenario& scenario, const PlannedBox& box, const Pose& X_WP,
                                            const Pose& X_PS, const Vector3& face, double travel_bottom, bool again);
/// Rows that press once on the middle of the box from above, the vacuum off, so that it comes to stand level.
[[nodiscard]] std::vector<motion::Waypoint> plan_press(const model::Scenario& scenario, const CellLayout& layout,
                                                       const PlannedBox& box, const Pose& X_WP, double travel_bottom);
/// Rows that put the held box on the flat surface, its orientation R_WP, and let go.
[[nodiscard]] std::vector<motion::Waypoint> plan_set_down(const model::Scenario& scenario, const PlannedBox& box,
                                                          const FlipPlace& place, const Matrix3& R_WP, const Pose& X_PS,
                                                          double travel_bottom);
/// Rows that turn the held box over its lower edge there and let go.
[[nodiscard]] std::vector<motion::Waypoint> plan_flip(const model::Scenario& scenario, const PlannedBox& box,
                                                      const FlipPlace& place, const Matrix3& R_WP, const Pose& X_PS,
                                                      double travel_bottom);

/// Tool over a box that hangs still from the cup where `X_PS` is the lip on it.
[[nodiscard]] ToolFor make_tool_for(const model::Scenario& scenario, const PlannedBox& box, const Pose& X_PS);

struct PlaceRequest {
  PlannedBox box;
  Pose X_PS;  ///< lip on the held box
  Pose X_TP;  ///< where it shall rest
  Insertion insertion;
  double packed_top = 0.0;  ///< m, z in T of the highest box in the container
  Pose X_WE;                ///< from here
  Pose X_EP;                ///< as the box hangs there
};
[[nodiscard]] std::vector<motion::Waypoint> plan_place(const model::Scenario& scenario, const CellLayout& layout,
                                                       const PlaceRequest& request);
}  // namespace snug::skills
