// Packer: what is done when a motion did not come to what was planned.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/session/packer.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::session {
namespace {

using motion::MotionClass;

/// Boxes under way at once: the item that came, one that it moved, one that this one moved.
constexpr std::size_t kMostHandled = 3;
constexpr int kMostReturns = 2;  ///< for one motion: the first may push a box that leans over

Trouble trouble_of(plant::EndReason reason) {
  switch (reason) {
    case plant::EndReason::Completed:
      return Trouble::None;
    case plant::EndReason::ForceGuard:
      return Trouble::ForceGuard;
    case plant::EndReason::HoldGuard:
      return Trouble::HoldGuard;
    case plant::EndReason::NoSeal:
      return Trouble::NoSeal;
    case plant::EndReason::VacuumLost:
      return Trouble::VacuumLost;
    case plant::EndReason::ProtectiveStop:
      return Trouble::ProtectiveStop;
    case plant::EndReason::Timeout:
      return Trouble::Timeout;
    case plant::EndReason::Cancelled:
    case plant::EndReason::Refused:
    case plant::EndReason::Fault:
      return Trouble::PlantFault;
  }
  return Trouble::PlantFault;
}

}  // namespace

void Packer::retreat(const std::string& id, ItemReport& report) {
  belief_.doubt_prediction();
  if (is_holding() || robot_.end.reason == plant::EndReason::VacuumLost) let_go_ = index_of(id);
  const double travel = travel_bottom(layout_, obstacle_top(-1));
  motion::Waypoint up = motion::make_waypoint(MotionClass::PostPlace, id, robot_.X_WE, {}, "_retreat");
  up.X_WE.p.z() = std::max(up.X_WE.p.z(), travel + scenario_.cup.free_length + scenario_.skills.travel.retreat);
  const motion::Waypoint let_go =
      motion::make_waypoint(MotionClass::Place, id, robot_.X_WE, {.blow_off = true}, "_release");
  const std::vector<motion::Waypoint> rows{let_go, up};
  for (int stops = 0; stops <= scenario_.recovery.most_stops; ++stops) {
    plant_.acknowledge();
    submit(id, layout_.is_fast ? with_detaching(layout_, rows) : rows, {std::nullopt, false}, report);
    if (robot_.end.reason != plant::EndReason::ProtectiveStop) return;
  }
}

void Packer::give_up(int item, Trouble trouble, ItemReport& report) {
  const std::optional<BelievedBox>& box = belief_.box(item);
  const bool is_gone = !box || trouble == Trouble::Gone;
  const bool is_waiting = box && locate(item) == Location::Aligner;
  report.end = is_gone ? ItemEnd::Gone : is_waiting ? ItemEnd::NotHeld : ItemEnd::Left;
  report.reason = name_of(trouble);
}

void Packer::leave(int item, ItemReport& report) const {
  if (std::ranges::find(order_, item) == order_.end()) return;
  if (locate(item) == Location::Aligner) {
    const bool was_returned = !report.recoveries.empty() && report.recoveries.back().remedy == Remedy::ReturnToAligner;
    report.end = was_returned ? ItemEnd::Returned : ItemEnd::NotHeld;
  } else {
    report.end = fit_of(item, belief_.box(item)->X_WP).is_in ? ItemEnd::Accepted : ItemEnd::Left;
  }
}

Trouble Packer::find_trouble(int item, const packing::Placement& planned,
                             const std::vector<std::optional<Pose>>& before, ItemReport& report) {
  const Trouble ended = trouble_of(robot_.end.reason);
  if (ended != Trouble::None && ended != Trouble::NoSeal && ended != Trouble::VacuumLost) return ended;
  if (ended != Trouble::None) retreat(report.id, report);
  look(report);
  const Trouble seen = assess(item, planned, before, report);
  return ended != Trouble::None ? ended : seen;
}

Situation Packer::situation_of(int item, Trouble trouble, packing::Agent& agent, const ItemReport& report) {
  Situation at;
  at.trouble = trouble;
  at.tries = static_cast<int>(report.sends.size());
  at.is_held = is_holding();
  at.can_set_down = layout_.flip_place.has_value();
  at.fits = belief_.box(item) && fit_of(item, belief_.box(item)->X_WP).is_in && who_sticks_out(item) < 0;
  at.leans = belief_.box(item) && locate(item) == Location::Container && tilt_of(item) > limits_.tilt;
  at.lies_turned = report.angle_error > scenario_.recovery.lies_turned;
  at.can_be_picked = can_be_picked(item);
  if (at.fits && !at.is_held) at.gain_elsewhere = gain_elsewhere(item, agent);
  return at;
}

void Packer::resume(const std::string& id, ItemReport& report) {
  plant_.acknowledge();
  const std::vector<motion::Waypoint> rest(last_.begin() + robot_.end.waypoint.value_or(motion::WaypointIndex()).value,
                                           last_.end());
  submit(id, rest, {limits_.force, true, limits_.hold_guard}, report);
}

void Packer::press(int item, ItemReport& report) {
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const double travel = travel_bottom(layout_, obstacle_top(-1));
  submit(box.id, plan_press(belief_.nominal(), layout_, box, belief_.box(item)->X_WP, travel),
         {scenario_.skills.press.force, false}, report);
  // The force that ends a press is what was asked for.
  if (robot_.end.reason == plant::EndReason::ForceGuard) retreat(box.id, report);
}

motion::Waypoint Packer::lift(const Carried& carried) const {
  motion::Waypoint up =
      motion::make_waypoint(MotionClass::PostPick, carried.box.id, robot_.X_WE, {.vacuum = true}, "_up");
  const double hanging = -2.0 * skills::lowest_corner(carried.R_WP, carried.box.size) + scenario_.cup.hold_length;
  up.X_WE.p.z() = std::max(up.X_WE.p.z(), travel_bottom(layout_, obstacle_top(-1)) + hanging);
  return up;
}

void Packer::put_down(const Carried& carried, const skills::FlipPlace& place, std::vector<motion::Waypoint> rows,
                      ItemReport& report) {
  const double travel = travel_bottom(layout_, obstacle_top(-1));
  const auto down = plan_set_down(belief_.nominal(), carried.box, place, carried.R_WP, carried.X_PS, travel);
  const motion::Waypoint here = motion::make_waypoint(MotionClass::PostPick, carried.box.id, robot_.X_WE, robot_.io);
  rows.insert(rows.end(), down.begin(), down.end());
  motion::Program program;
  append(program, drivable(layout_, here, rows, carried.swing));
  submit(carried.box.id, program.waypoints, {std::nullopt, true}, report);
}

void Packer::set_down(const Planned& planned, ItemReport& report) {
  belief_.doubt_prediction();
  let_go_ = planned.box.item;
  const Carried carried{planned.box, layout_.X_WT.R * planned.attempt.planned.X_TP.R, planned.attempt.X_PS,
                        planned.attempt.swing};
  put_down(carried, *layout_.flip_place, {lift(carried)}, report);
}

Matrix3 Packer::rotation_at_aligner(int item) const {
  const Matrix3& R_WA = scenario_.aligner->X_WA.R;
  const Matrix3& R_WP = belief_.box(item)->X_WP.R;
  return R_WA * packing::rotation(packing::nearest_orientation(R_WA.transpose() * skills::leveling(R_WP) * R_WP));
}

std::vector<motion::Waypoint> Packer::plan_pick_to_return(int item, const Matrix3& R_WP) const {
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const Pose& X_WP = belief_.box(item)->X_WP;
  const Pose X_WP_next{R_WP, scenario_.aligner->X_WA.p};
  const double travel = travel_bottom(layout_, obstacle_top(-1));
  if (is_upright(X_WP.R, scenario_.skills.pick.max_lean))
    return plan_pick(belief_.nominal(), layout_, box, X_WP, X_WP_next, travel, skills::PickKind::FromAfar);
  return plan_leaning_pick(belief_.nominal(), layout_, box, X_WP, X_WP_next, travel);
}

bool Packer::can_return(int item) const {
  if (is_holding()) return true;
  if (!belief_.box(item) || is_under_obstacle(item) || locate(item) == Location::Aligner) return false;
  return !reaches_ || std::ranges::all_of(plan_pick_to_return(item, rotation_at_aligner(item)), [&](const auto& row) {
    return reaches_({row.X_WE, row.X_WE});
  });
}

void Packer::return_to_aligner(int item, const Planned* planned, ItemReport& report) {
  belief_.doubt_prediction();
  let_go_ = item;
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const Pose& X_WA = scenario_.aligner->X_WA;
  const Pose& X_WP = belief_.box(item)->X_WP;
  const bool is_held = planned != nullptr && is_holding();
  const Matrix3 R_WP = is_held ? Matrix3(X_WA.R * planned->attempt.planned.X_TP.R) : rotation_at_aligner(item);
  Carried carried{box, R_WP, Pose{}, std::nullopt};
  const Pose arrival = cell::arrival_pose(belief_.nominal(), belief_.sequence().items[static_cast<std::size_t>(item)]);
  const Vector3 middle =
      Vector3::Constant(scenario_.recovery.return_distance) + 0.5 * ((X_WA.R.transpose() * R_WP).cwiseAbs() * box.size);
  skills::FlipPlace place{X_WA * middle, Vector3::UnitX()};
  place.p_WF.z() = arrival.p.z() + skills::lowest_corner(arrival.R, box.size);
  std::vector<motion::Waypoint> rows;
  if (is_held) {
    carried.X_PS = planned->attempt.X_PS;
    carried.swing = planned->attempt.swing;
    rows = {lift(carried)};
  } else {
    rows = plan_pick_to_return(item, R_WP);
    const auto pick = std::ranges::find(rows, MotionClass::RePick, &motion::Waypoint::motion_class);
    const Pose X_ES{Matrix3::Identity(), cup::pick_length(scenario_.cup) * Vector3::UnitZ()};
    carried.X_PS = X_WP.inverse() * pick->X_WE * X_ES;
  }
  put_down(carried, place, std::move(rows), report);
}

bool Packer::repack(int item, packing::Agent& agent, ItemReport& report) {
  ItemReport own;
  own.id = items_[static_cast<std::size_t>(item)].id;
  const double begin = robot_.time;
  bring_to_place(item, agent, {}, own);
  report.attempts += own.attempts;
  report.planning_wait += own.planning_wait;
  report.seconds += own.seconds;
  report.recoveries.insert(report.recoveries.end(), own.recoveries.begin(), own.recoveries.end());
  if (robot_.end.reason != plant::EndReason::Completed) retreat(own.id, report);
  if (belief_.box(item) && locate(item) == Location::Aligner) {
    belief_.forget(item);  // the next arrival takes it away
    returned_.insert(item);
  } else if (belief_.box(item) && is_seen_outside(own.id)) {
    left_out_.insert(item);
  } else if (belief_.box(item) && !own.sends.empty()) {
    repacked_.push_back({own.planned, layout_.X_WT.inverse() * belief_.box(item)->X_WP});
  }
  return robot_.time > begin;
}

bool Packer::recover(int item, const Planned& planned, std::vector<std::optional<Pose>> before, packing::Agent& agent,
                     ItemReport& report) {
  int stops = 0, repacked = 0, returns = 0;
  bool was_pressed = false;
  const packing::Placement goal = planned.attempt.planned;
  Trouble trouble = find_trouble(item, goal, before, report);
  for (int round = 0; round < scenario_.recovery.most_rounds && trouble != Trouble::None; ++round) {
    if (report.sends.back().trouble == Trouble::None) report.sends.back().trouble = trouble;
    // It may be another box that sticks out or was moved: then that is pressed, or taken out and packed anew.
    const int culprit = trouble == Trouble::SticksOut        ? who_sticks_out(item)
                        : trouble == Trouble::NeighbourMoved ? who_was_moved(item, before)
                                                             : item;
    stops += trouble == Trouble::ProtectiveStop ? 1 : 0;
    Situation at = situation_of(culprit, trouble, agent, report);
    if (culprit != item) {
      at.tries = handled_.size() < kMostHandled ? 1 + repacked : scenario_.recovery.most_tries;
      at.lies_on_others = was_lifted(culprit, before);
    }
    at.stops = stops;
    at.can_return = returns < kMostReturns && !ahead_ && can_return(culprit);
    at.was_pressed = was_pressed || (belief_.box(culprit) && is_under_obstacle(culprit));
    const Remedy remedy = choose_remedy(at, scenario_.recovery);
    const bool is_of_motion = trouble_of(robot_.end.reason) == trouble;
    std::string detail = is_of_motion ? plant::describe(robot_.end, last_) : std::string();
    if (culprit != item) detail = items_[static_cast<std::size_t>(culprit)].id;
    if (at.gain_elsewhere > 0.05)
      detail += fmt::format("{}{:.1f} % more expected elsewhere", detail.empty() ? "" : ", ", at.gain_elsewhere);
    report.recoveries.push_back({robot_.time, report.id, trouble, remedy, std::move(detail)});
    switch (remedy) {
      case Remedy::None:
      case Remedy::Accept:
        if (culprit != item) break;
        report.end = ItemEnd::Accepted;
        return false;
      case Remedy::PickAgain:
        if (culprit == item) return true;
        repacked = repack(culprit, agent, report) ? repacked + 1 : scenario_.recovery.most_tries;
        was_pressed = false;
        break;
      case Remedy::ReturnToAligner:
        ++returns;
        return_to_aligner(culprit, culprit == item ? &planned : nullptr, report);
        if (robot_.end.reason != plant::EndReason::Completed) break;
        look(report);
        if (belief_.box(culprit) && locate(culprit) != Location::Aligner) break;  // it did not come there
        if (belief_.box(culprit) && at.tries < scenario_.recovery.most_tries) {
          if (culprit == item) return true;
          ++repacked;
          (void)repack(culprit, agent, report);
          was_pressed = false;
          break;
        }
        belief_.forget(culprit);  // the next arrival takes it away
        if (culprit != item) {
          returned_.insert(culprit);
          break;
        }
        report.end = ItemEnd::Returned;
        report.reason = name_of(trouble);
        return false;
      case Remedy::Skip:
        left_out_.insert(culprit);
        if (culprit != item) break;
        give_up(item, trouble, report);
        return false;
      case Remedy::Stop:
        stop_reason_ = trouble == Trouble::PlantFault ? StopReason::PlantFault : StopReason::RobotStops;
        give_up(item, trouble, report);
        return false;
      case Remedy::LookAgain:
      case Remedy::MoveAway:
      case Remedy::Believe:  // of pictures: take_picture
        break;
      case Remedy::Resume:
        resume(report.id, report);
        break;
      case Remedy::SetDown:
        set_down(planned, report);
        if (robot_.end.reason != plant::EndReason::Completed) break;
        look(report);
        if (can_be_picked(item)) return true;
        break;
      case Remedy::Release:
        retreat(report.id, report);
        break;
      case Remedy::PressLevel:
        was_pressed = true;
        press(culprit, report);
        break;
    }
    if (culprit != item && remedy != Remedy::PressLevel) before[static_cast<std::size_t>(culprit)] = pose_of(culprit);
    trouble = find_trouble(item, goal, before, report);
  }
  if (trouble == Trouble::None || trouble == Trouble::NeighbourMoved) {
    report.end = ItemEnd::Placed;
  } else {
    give_up(item, trouble, report);
  }
  return false;
}

}  // namespace snug::session
