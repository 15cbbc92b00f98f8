// ItemPlan: from a box and the place it shall have to the rows that bring it there.
#include "snug/skills/item_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cup/phases.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/cup/statics.hpp"
#include "snug/cup/swing.hpp"
#include "snug/motion/fast_settings.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/way.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/skills/gripper_pick.hpp"
#include "snug/skills/internal/row_parts.hpp"
#include "snug/skills/unwinding.hpp"

namespace snug::skills {
namespace {

using motion::MotionClass;

/// How far below `bottom` [m, z in W] a held box comes on a fast way, and after which share of it.
struct Dip {
  double depth = 0.0;  ///< m, 0: it stays over it
  double share = 0.0;
};

Dip find_dip(const CellLayout& layout, const Pose& X_WE_from, const Pose& X_WE_to, const Pose& X_EP,
             const Vector3& size, double bottom) {
  constexpr int kLooks = 24;
  const motion::Way way(X_WE_from, X_WE_to, layout.pan_axis);
  Dip dip;
  for (int i = 0; i <= kLooks; ++i) {
    const double share = static_cast<double>(i) / kLooks;
    const Pose X_WP = way.at(share) * X_EP;
    const double depth = bottom - (X_WP.p.z() + lowest_corner(X_WP.R, size));
    if (depth > dip.depth) dip = {depth, share};
  }
  return dip;
}

/// Of the tempo, chosen: 10 mm in a second. A box of 6 kg that is let go at the fastest then bounces by 0.7 m/s2.
constexpr double kPaceOfTakingWeight = 0.1;

constexpr int kRaises = 4;           ///< rounds in which an end of a way is raised until nothing is met on it
constexpr double kLeastLever = 0.3;  ///< of a raised end, where the way is lowest

double yaw_between(const Matrix3& R_from, const Matrix3& R_to) {
  const Matrix3 R = R_to * R_from.transpose();
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

PickIntent pick_intent(const model::Scenario& scenario, const CellLayout& layout, const PlannedBox& box,
                       const Pose& X_WP, const Pose& X_WP_next, double travel, PickKind kind) {
  const settings::PickParams& params = scenario.skills.pick;
  PickIntent intent;
  intent.box = box.id;
  intent.X_WP = X_WP;
  intent.size = box.size;
  intent.cup_offset_P = cup_offset(scenario.cup, params.seal_margin, box, X_WP.R);
  intent.tool_yaw = layout.neutral_yaw - 0.5 * turn_between(layout, X_WP, X_WP_next);
  if (scenario.gripper) {
    const TopFace face{X_WP, box.size, box.inertia.mass, box.inertia.com};
    const auto pick =
        choose_gripper_pick(*scenario.gripper, params.seal_margin, face, intent.tool_yaw, scenario.gravity.norm());
    if (pick) {  // else as with one cup: the rehearsal says why nothing seals
      intent.tool_yaw = pick->tool_yaw;
      intent.cup_offset_P = pick->offset_P;
    }
  }
  intent.length = cup::pick_length(scenario.cup);
  intent.again = kind != PickKind::First;
  const double height = -2.0 * lowest_corner(X_WP.R, box.size);
  const double top = X_WP.p.z() + 0.5 * height;
  intent.approach_height =
      scenario.cup.free_length + (kind == PickKind::FromAbove
                                      ? top + params.above_box
                                      : std::max(travel + params.above_travel, top + crossing_clearance(layout)));
  intent.lift_height = travel + height + scenario.cup.hold_length;
  return intent;
}

/// Of the height of a pushed box: so far below its upper edge the force of the push is to act.
constexpr double kPushBelowTop = 0.2;
constexpr double kMostPushLean = 0.09;  ///< rad

/// rad, of the tool: the moment of the cup that is bent so takes the force of the push from the height of the lip to
/// that depth. A box that hangs upright would be turned until its upper edge alone is pressed.
double lean_of_push(const model::Scenario& scenario, const PlaceRequest& request) {
  const double height = (request.X_TP.R.row(2).cwiseAbs() * request.box.size).value();
  const double force = scenario.cup.stiffness.lateral * request.insertion.overtravel_T.norm();
  const double moment = force * kPushBelowTop * height;
  return moment < scenario.cup.stiffness.bend * kMostPushLean ? moment / scenario.cup.stiffness.bend : kMostPushLean;
}

}  // namespace

const char* name_of(Reorientation reorientation) {
  switch (reorientation) {
    case Reorientation::None:
      return "";
    case Reorientation::SideGrasp:
      return "side grasp";
    case Reorientation::Regrasp:
      return "regrasp";
    case Reorientation::Pivot:
      return "pivot";
  }
  return "";
}

PlannedBox make_planned_box(const model::Scenario& scenario, const model::Sequence& sequence, model::ItemIndex item) {
  const std::string& id = sequence.items[item.slot()].parcel;
  const model::Parcel& parcel = *model::find_parcel(scenario, id);
  return {item, id, model::collision_size(scenario, parcel), parcel.inertia};
}

Vector3 cup_offset(const model::CupParams& cup, double seal_margin, const PlannedBox& box, const Matrix3& R_WP) {
  return choose_cup_offset(R_WP, box.size, box.inertia.com, 0.5 * cup.effective_diameter + seal_margin);
}

double turn_between(const CellLayout& layout, const Pose& X_WP, const Pose& X_WP_next) {
  const double turn = yaw_between(X_WP.R, X_WP_next.R);
  if (!layout.is_fast || !layout.pan_axis) return turn;
  const double pan = motion::pan_between(layout.pan_axis->p_WB, X_WP.p, X_WP_next.p);
  const double other = turn - std::copysign(2.0 * std::numbers::pi, turn);
  return std::abs(other) <= layout.travel.longest_turn && std::abs(pan - other) < std::abs(pan - turn) ? other : turn;
}

std::vector<motion::Waypoint> plan_pick(const model::Scenario& scenario, const CellLayout& layout,
                                        const PlannedBox& box, const Pose& X_WP, const Pose& X_WP_next, double travel,
                                        PickKind kind) {
  PickIntent intent = pick_intent(scenario, layout, box, X_WP, X_WP_next, travel, kind);
  const int up = internal::vertical_axis_of(X_WP.R);
  const Vector3 up_P = std::copysign(1.0, X_WP.R(2, up)) * Vector3::Unit(up);
  if (!layout.is_fast || may_push_hanging(scenario, box, up_P)) return pick_rows(intent);
  // What the box stands on lets it go while the tool moves: it starts at the tool's speed, and bounces. So the cup
  // takes the weight slowly.
  intent.slow_lift = box.inertia.mass * scenario.gravity.norm() / scenario.cup.stiffness.axial;
  std::vector<motion::Waypoint> rows = pick_rows(intent);
  motion::Swing slow = swing_of(scenario, box, up_P);
  slow.pace = kPaceOfTakingWeight;
  rows[rows.size() - 2].swing = motion::as_named(slow);
  return rows;
}

Pose tool_before_pick(const model::Scenario& scenario, const CellLayout& layout, const PlannedBox& box,
                      const Pose& X_WP, double travel) {
  return plan_pick(scenario, layout, box, X_WP, X_WP, travel, PickKind::First).front().X_WE;
}

std::vector<motion::Waypoint> plan_leaning_pick(const model::Scenario& scenario, const CellLayout& layout,
                                                const PlannedBox& box, const Pose& X_WP, const Pose& X_WP_next,
                                                double travel) {
  return leaning_pick_rows(pick_intent(scenario, layout, box, X_WP, X_WP_next, travel, PickKind::FromAfar),
                           scenario.skills.pick.leaning_lift);
}

double still_hold_factor(const model::Scenario& scenario, const PlannedBox& box) {
  double most = 0.0;
  for (const double sign : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      const SpatialInertia box_S = cup::box_below_lip(scenario.cup, box.inertia, box.size, sign * Vector3::Unit(axis));
      most = std::max(most, cup::carried_hold_factor(scenario.cup, box_S, {0.0, 0.0, -scenario.gravity.norm()}));
    }
  }
  return most;
}

bool may_push_hanging(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P) {
  constexpr double kMargin = 1.25;  ///< chosen: the tool needs a way to stop
  const SpatialInertia box_S = cup::box_below_lip(scenario.cup, box.inertia, box.size, up_P);
  const motion::FastSettings fast;
  const double still = cup::carried_hold_factor(scenario.cup, box_S, {0.0, 0.0, -scenario.gravity.norm()});
  return std::min(fast.felt_hold, fast.felt_hold_share * still) >= kMargin * scenario.place_limits.hold_factor;
}

double pace_of(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P) {
  constexpr double kMargin = 1.05;  ///< chosen, over what a rehearsal asks for
  /// The same where the cup carries little more than the weight: masses and centres of mass are not known better.
  constexpr double kMarginOfHeaviest = 1.25;
  constexpr double kLeast = 0.2;      ///< chosen
  constexpr double kStep = 0.05;      ///< of the search
  constexpr double kOvershoot = 2.0;  ///< of the lift: its smoothing is shorter than a heavy box bounces; 1.9 with 6 kg
  const SpatialInertia box_S = cup::box_below_lip(scenario.cup, box.inertia, box.size, up_P);
  const double margin = may_push_hanging(scenario, box, up_P) ? kMargin : kMarginOfHeaviest;
  const double gravity = scenario.gravity.norm(), asked = margin * scenario.place_limits.hold_factor;
  const motion::FastSettings fast;
  const auto holds = [&](double pace) {
    const double square = pace * pace;
    const auto factor = [&](double level, double up) {
      return cup::carried_hold_factor(scenario.cup, box_S, {square * level, 0.0, -gravity - square * up});
    };
    const double lift = kOvershoot * fast.held.max_acceleration;
    return std::min({factor(0.0, lift), factor(0.0, fast.insert.max_acceleration),
                     factor(fast.held.max_acceleration, 0.0)}) >= asked;
  };
  int steps = static_cast<int>(std::lround(1.0 / kStep));
  while (steps * kStep > kLeast + 0.5 * kStep && !holds(steps * kStep)) --steps;
  return steps * kStep;
}

motion::Swing swing_of(const model::Scenario& scenario, const PlannedBox& box, const Vector3& up_P) {
  const settings::TravelParams& travel = scenario.skills.travel;
  const cup::Swing swing = cup::find_swing(scenario.cup, box.inertia, box.size, up_P, scenario.gravity.norm());
  return {std::clamp(swing.slow, travel.shortest_swing, travel.longest_swing),
          std::clamp(swing.fast, travel.shortest_swing, travel.longest_swing), pace_of(scenario, box, up_P)};
}

std::vector<motion::Waypoint> drivable(const CellLayout& layout, const motion::Waypoint& last,
                                       const std::vector<motion::Waypoint>& rows,
                                       const std::optional<motion::Swing>& swing) {
  if (rows.empty()) return rows;
  if (layout.is_fast) {
    std::vector<motion::Waypoint> turned = with_turns(
        last, with_detaching(layout, rows), {layout.neutral_yaw, layout.travel.sure_turn, true, layout.pan_axis});
    for (motion::Waypoint& row : turned) {
      const bool hangs = !motion::is_contact(row.motion_class) || row.motion_class == MotionClass::Place;
      if (swing && !row.swing && row.io.vacuum && hangs) row.swing = motion::as_named(*swing);
    }
    return turned;
  }
  const std::vector<motion::Waypoint> turned = with_turns(last, rows, {layout.neutral_yaw, layout.travel.sure_turn});
  if (!layout.pan_axis) return turned;
  return with_detours(last, turned, layout.pan_axis->p_WB, layout.travel.near_base, layout.travel.base_radius);
}

std::vector<motion::Waypoint> with_detaching(const CellLayout& layout, const std::vector<motion::Waypoint>& rows) {
  std::vector<motion::Waypoint> detaching;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    detaching.push_back(rows[i]);
    const bool lets_go = rows[i].io == internal::kRelease && rows[i].motion_class != MotionClass::TwistDrag;
    if (!lets_go || i + 1 == rows.size()) continue;
    motion::Waypoint off = rows[i];
    off.motion_class = rows[i + 1].motion_class;
    off.variant = "_off";
    off.X_WE.p -= (layout.cup_growth + layout.travel.detach) * rows[i].X_WE.R.col(2);
    detaching.push_back(off);
  }
  return detaching;
}

Matrix3 orientation_before_flip(const Matrix3& R_WP, const Vector3& up_P, const Vector3& direction) {
  const Vector3 now = R_WP * up_P;
  const double yaw = std::atan2(direction.y(), direction.x()) - std::atan2(now.y(), now.x());
  return exp_rotation(Vector3(0.0, 0.0, yaw)) * R_WP;
}

std::vector<motion::Waypoint> plan_side_pick(const model::Scenario& scenario, const CellLayout& layout,
                                             const PlannedBox& box, const Pose& X_WP, const Vector3& face,
                                             const Pose& X_WP_next, double travel, bool again) {
  const model::CupParams& cup = scenario.cup;
  const settings::SideGraspParams& params = scenario.skills.side_grasp;
  SidePickIntent intent;
  intent.params = params;
  intent.box = box.id;
  intent.X_WP = X_WP;
  intent.size = box.size;
  intent.face = face;
  intent.again = again;
  const Matrix3 R_WP_up = face_up(X_WP.R, face);
  intent.cup_offset_P = cup_offset(cup, scenario.skills.pick.seal_margin, box, R_WP_up);
  // The lip stays off what the box stands on; where the side is too low for that it reaches over its upper edge.
  const double half_height = -lowest_corner(X_WP.R, box.size);
  const double low = cup.lip_radius + params.lip_clearance - half_height;
  const double offset = (X_WP.R * intent.cup_offset_P).z();
  if (offset < low) intent.cup_offset_P += (low - offset) * X_WP.R.transpose() * Vector3::UnitZ();
  if (low + cup.lip_radius - half_height > cup.seal.max_overhang - params.lip_clearance) return {};
  intent.tool_yaw = layout.neutral_yaw - 0.5 * turn_between(layout, {R_WP_up, X_WP.p}, X_WP_next);
  // At the aligner the plates hold the box against the cup. Elsewhere the lip just touches, and pulls the box to
  // itself.
  intent.length = again ? cup.free_length : cup::pick_length(cup);
  intent.lift = std::max(params.least_lift, travel - (X_WP.p.z() - half_height));
  intent.approach_height = travel + half_height;
  std::vector<motion::Waypoint> rows = side_pick_rows(intent);
  if (!layout.is_fast) return rows;
  if (again) {  // it was set down by a tool that is still over it
    const double top = X_WP.p.z() + half_height;
    rows.front().X_WE.p.z() =
        std::max(rows.front().X_WE.p.z(), top + cup.free_length + layout.travel.turning_clearance);
  }
  SidePickPoses poses = side_pick_poses(intent);
  const Pose X_EP = poses.X_WE_pick.inverse() * X_WP;
  Pose X_WP_over = X_WP_next;
  X_WP_over.p.z() = travel - lowest_corner(X_WP_next.R, box.size);
  for (int i = 0; i < kRaises; ++i) {
    Pose& X_WE_lifted = poses.X_WE_lifted;
    const Dip dip = find_dip(layout, X_WE_lifted, X_WP_over * X_EP.inverse(), X_EP, box.size,
                             travel - crossing_clearance(layout) + layout.travel.turning_clearance);
    X_WE_lifted.p.z() += dip.depth / std::max(kLeastLever, 1.0 - dip.share);
  }
  rows.back().X_WE.p = poses.X_WE_lifted.p;
  return rows;
}

motion::Waypoint plan_turn_up(const model::Scenario& scenario, const PlannedBox& box, const Pose& X_WP,
                              const Pose& X_PS, const Vector3& face, double travel, bool again) {
  const Matrix3 R_WP = face_up(X_WP.R, face);
  Pose X_WP_up{R_WP, X_WP.p};
  X_WP_up.p.z() = travel + scenario.skills.side_grasp.turn_clearance - lowest_corner(R_WP, box.size);
  return motion::make_waypoint(again ? MotionClass::PostRePick : MotionClass::PostPick, box.id,
                               make_tool_for(scenario, box, X_PS)(X_WP_up), {.vacuum = true}, "_up");
}

std::vector<motion::Waypoint> plan_press(const model::Scenario& scenario, const CellLayout& layout,
                                         const PlannedBox& box, const Pose& X_WP, double travel) {
  const double top = X_WP.p.z() - lowest_corner(X_WP.R, box.size);
  const double free = scenario.cup.free_length;
  Pose X_WE{motion::upright_tool(layout.neutral_yaw), X_WP.p};
  const auto row_at = [&](MotionClass motion_class, double z) {
    X_WE.p.z() = z;
    return motion::make_waypoint(motion_class, box.id, X_WE, {}, "_press");
  };
  const settings::PressParams& params = scenario.skills.press;
  const double over = std::max(travel, top) + free + params.stand_off;
  return {row_at(MotionClass::PrePlace, over), row_at(MotionClass::PlaceSlow, top + free - params.depth),
          row_at(MotionClass::PostPlace, over)};
}

std::vector<motion::Waypoint> plan_set_down(const model::Scenario& scenario, const PlannedBox& box,
                                            const FlipPlace& place, const Matrix3& R_WP, const Pose& X_PS,
                                            double travel) {
  SetDownIntent intent;
  intent.params = scenario.skills.set_down;
  intent.box = box.id;
  intent.size = box.size;
  intent.X_WP = {R_WP, place.p_WF - lowest_corner(R_WP, box.size) * Vector3::UnitZ()};
  intent.travel_bottom = travel;
  intent.tool_for = make_tool_for(scenario, box, X_PS);
  return set_down_rows(intent);
}

std::vector<motion::Waypoint> plan_flip(const model::Scenario& scenario, const PlannedBox& box, const FlipPlace& place,
                                        const Matrix3& R_WP, const Pose& X_PS, double travel) {
  FlipIntent intent;
  intent.params = scenario.skills.pivot;
  intent.box = box.id;
  intent.size = box.size;
  intent.p_WF = place.p_WF;
  intent.direction = place.direction;
  intent.R_WP = R_WP;
  intent.travel_bottom = travel;
  intent.tool_for = make_tool_for(scenario, box, X_PS);
  intent.X_PE = X_PS * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -scenario.cup.hold_length)};
  return flip_rows(intent);
}

ToolFor make_tool_for(const model::Scenario& scenario, const PlannedBox& box, const Pose& X_PS) {
  const model::CupParams& params = scenario.cup;
  cup::HeldLoad load;
  load.mass = box.inertia.mass;
  load.p_SScm = X_PS.inverse() * box.inertia.com;
  load.stiffness = cup::as_matrix(params.stiffness);
  load.law = params.law;
  load.X_ES2 = Pose{Matrix3::Identity(), Vector3(0.0, 0.0, params.hold_length - params.centre_from_lip)};
  load.X_SS1 = Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -params.centre_from_lip)};
  load.gravity_W = scenario.gravity;
  const Pose X_ES_rest{Matrix3::Identity(), Vector3(0.0, 0.0, params.hold_length)};
  return [load, X_PS, X_ES_rest](const Pose& X_WP) {
    // The sag depends on how the tool is turned, and that on the sag: a few rounds settle it to below 0.02 degrees
    // with a centre of mass and a cup within 20 mm of the middle, to 0.06 degrees within 50 mm.
    Pose X_ES = X_ES_rest;
    for (int i = 0; i < 4; ++i) {
      cup::HeldLoad turned = load;
      turned.R_WE = X_WP.R * X_PS.R * X_ES.R.transpose();
      const cup::SettleResult result = cup::settle(turned);
      if (result.status != cup::SettleStatus::Converged) break;
      X_ES = result.X_ES;
    }
    return X_WP * X_PS * X_ES.inverse();
  };
}

std::vector<motion::Waypoint> plan_place(const model::Scenario& scenario, const CellLayout& layout,
                                         const PlaceRequest& request) {
  const Matrix3& R_WT = layout.X_WT.R;
  PlaceIntent intent;
  intent.params = scenario.skills.insertion;
  intent.box = request.box.id;
  intent.X_WP = layout.X_WT * request.X_TP;
  intent.size = request.box.size;
  intent.tool_for = make_tool_for(scenario, request.box, request.X_PS);
  intent.travel_bottom = travel_bottom(layout, request.packed_top);
  const double rim = std::max(layout.rim, request.packed_top);
  intent.entry_bottom = layout.X_WT.p.z() + rim + intent.params.entry_clearance;
  intent.come_from = R_WT * request.insertion.come_from_T;
  intent.overtravel = R_WT * request.insertion.overtravel_T;
  intent.gentle = request.insertion.gentle;
  if (request.insertion.skill == InsertionSkill::Tilted) {
    TiltedEntry entry;
    entry.low_side = R_WT * request.insertion.low_side_T;
    entry.push = R_WT * request.insertion.push_T;
    entry.edge_height = layout.X_WT.p.z() + request.insertion.edge_height_T;
    intent.tilted = entry;
  }
  if (request.insertion.skill == InsertionSkill::SlideOnSupport) {
    // From where it hangs down to where the cup would carry nothing of it, and beyond: the support gives way as well.
    const Pose X_WE_unloaded =
        intent.X_WP * request.X_PS * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -scenario.cup.hold_length)};
    intent.lowered = intent.tool_for(intent.X_WP).p.z() - X_WE_unloaded.p.z() + intent.params.press;
    // So far the tool leads the box when the push is felt.
    const double lead = motion::FastSettings().push_force / scenario.cup.stiffness.lateral;
    for (int axis = 0; axis < 2; ++axis) {
      if (request.insertion.overtravel_T[axis] == 0.0) continue;
      intent.overtravel += std::copysign(lead, request.insertion.overtravel_T[axis]) * R_WT.col(axis);
    }
  }
  if (!layout.is_fast) return place_rows(intent);
  if (request.insertion.skill == InsertionSkill::SlideToContact && !scenario.gripper) {
    intent.push_lean = lean_of_push(scenario, request);
    intent.lip = scenario.cup.hold_length;
  }
  intent.entry_bottom = intent.X_WP.p.z() + lowest_corner(intent.X_WP.R, intent.size);  // straight down
  const double least = intent.travel_bottom - crossing_clearance(layout) + layout.travel.turning_clearance;
  for (int i = 0; i < kRaises; ++i) {
    const Pose X_WE_over = tool_over_place(intent);
    const Dip dip = find_dip(layout, request.X_WE, X_WE_over, request.X_EP, intent.size, least);
    intent.travel_bottom += dip.depth / std::max(kLeastLever, dip.share);
  }
  return place_rows(intent);
}

}  // namespace snug::skills
