// Packer: motions sent, what they came to, and what is done when that is not what was planned.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/cup/pick_length.hpp"
#include "snug/plant/motion_watch.hpp"
#include "snug/session/packer.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::session {
namespace {

using motion::MotionClass;

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
    case plant::EndReason::Refused:
    case plant::EndReason::Fault:
      return Trouble::PlantFault;
  }
  return Trouble::PlantFault;
}

double tilt_of(const Pose& X_TP) {
  return angle_between(packing::rotation(packing::nearest_orientation(X_TP.R)), X_TP.R);
}

/// m, what a look may be off: two standard deviations.
double slack_of(const BelievedBox& box) { return 2.0 * std::sqrt(std::max(0.0, box.covariance(0, 0))); }

}  // namespace

std::vector<std::optional<Pose>> Packer::believed_poses() const {
  std::vector<std::optional<Pose>> poses;
  for (int i = 0; i < static_cast<int>(items_.size()); ++i) {
    poses.push_back(belief_.box(i) ? std::optional<Pose>(belief_.box(i)->X_WP) : std::nullopt);
  }
  return poses;
}

void Packer::submit(const std::string& id, std::vector<motion::Waypoint> waypoints, const plant::Guards& guards,
                    ItemReport& report) {
  last_ = std::move(waypoints);
  sent_.waypoints.insert(sent_.waypoints.end(), last_.begin(), last_.end());
  robot_ = plant_.submit({id, last_, guards});
  report.seconds += split_seconds(last_, robot_.times);
  report.happened.force = std::max(report.happened.force, robot_.peak_force);
  report.happened.torque = std::max(report.happened.torque, robot_.peak_torque);
}

bool Packer::was_stopped_by_load() const {
  const plant::EndReason reason = robot_.end.reason;
  const bool is_of_load = reason == plant::EndReason::ForceGuard || reason == plant::EndReason::VacuumLost ||
                          reason == plant::EndReason::HoldGuard || reason == plant::EndReason::ProtectiveStop;
  if (!is_of_load || robot_.end.waypoint < 0) return false;
  const MotionClass at = last_[static_cast<std::size_t>(robot_.end.waypoint)].motion_class;
  return at == MotionClass::Place || at == MotionClass::PlaceSlow;
}

bool Packer::send(const Attempt& attempt, const std::string& id, ItemReport& report) {
  const auto& all = attempt.program.waypoints;
  const int item = index_of(id);
  std::size_t begin = 0;
  for (std::size_t stage = 0; stage <= attempt.looks.size(); ++stage) {
    const bool is_last = stage == attempt.looks.size();
    const std::size_t end = is_last ? all.size() : attempt.looks[stage];
    if (is_last) {
      belief_.expect(attempt.ends);
    } else {
      belief_.expect_on_the_way(item, attempt.looked[stage]);
    }
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
    submit(id, {first, all.begin() + static_cast<std::ptrdiff_t>(end)}, {limits_.force, true, limits_.hold_guard},
           report);
    if (was_stopped_by_load()) belief_.stiffen();
    if (robot_.end.reason != plant::EndReason::Completed || is_last) return true;
    look(report, true);
    const std::optional<BelievedBox>& box = belief_.box(item);
    const Pose& rehearsed = attempt.looked[stage];
    if (box && box->was_seen &&
        ((box->X_WP.p - rehearsed.p).norm() > scenario_.recovery.as_rehearsed + slack_of(*box) ||
         angle_between(box->X_WP.R, rehearsed.R) > scenario_.recovery.turned_as_rehearsed)) {
      return false;
    }
    begin = end;
  }
  return true;
}

int Packer::who_sticks_out(int item) const {
  const auto is_out = [&](int one) {
    return !left_out_.contains(one) && is_seen_outside(items_[static_cast<std::size_t>(one)].id);
  };
  for (const int other : order_) {
    if (other == item || !belief_.box(other)) continue;
    if (locate(other) == Location::Container && is_out(other)) return other;
  }
  return is_out(item) ? item : -1;
}

Trouble Packer::assess(int item, const packing::Placement& planned, const std::vector<std::optional<Pose>>& before,
                       ItemReport& report) const {
  const std::optional<BelievedBox>& box = belief_.box(item);
  if (!box) return Trouble::Gone;
  const Pose X_TP = layout_.X_WT.inverse() * box->X_WP;
  report.X_TP = X_TP;
  report.position_error = (X_TP.p - planned.X_TP.p).head<2>().norm();
  report.angle_error = angle_between(X_TP.R, planned.X_TP.R);
  double moved = 0.0;
  for (const int other : order_) {
    const std::optional<Pose>& was = before[static_cast<std::size_t>(other)];
    if (other == item || !was || !belief_.box(other) || !belief_.box(other)->was_seen) continue;
    moved = std::max(moved, (belief_.box(other)->X_WP.p - was->p).norm() - slack_of(*belief_.box(other)));
  }
  report.happened.displacement = std::max(0.0, moved);
  if (locate(item) != Location::Container) return Trouble::OffPlace;  // nothing there is to be pressed on
  if (tilt_of(X_TP) > limits_.tilt) return Trouble::Leaning;
  if (who_sticks_out(item) >= 0) return Trouble::SticksOut;
  if (report.position_error > limits_.position || report.angle_error > limits_.tilt) {
    return Trouble::OffPlace;
  }
  return moved > limits_.displacement ? Trouble::NeighbourMoved : Trouble::None;
}

bool Packer::is_holding() const {
  return robot_.io.vacuum &&
         robot_.pressure_gauge < scenario_.motion_guards.needed_vacuum * scenario_.cup.vacuum.pressure_gauge_hold;
}

void Packer::retreat(const std::string& id, ItemReport& report) {
  belief_.doubt_prediction();
  if (is_holding() || robot_.end.reason == plant::EndReason::VacuumLost) let_go_ = index_of(id);
  const double travel = travel_bottom(layout_, obstacle_top(-1));
  motion::Waypoint up = motion::make_waypoint(MotionClass::PostPlace, id, robot_.X_WE, {}, "_retreat");
  up.p_WE.z() = std::max(up.p_WE.z(), travel + scenario_.cup.free_length + scenario_.skills.travel.retreat);
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
  if (report.sends.empty()) return;
  if (locate(item) == Location::Aligner) {
    report.end = ItemEnd::NotHeld;
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

Situation Packer::situation_of(int item, Trouble trouble, const ItemReport& report) const {
  Situation at;
  at.trouble = trouble;
  at.tries = static_cast<int>(report.sends.size());
  at.is_held = is_holding();
  at.can_set_down = layout_.flip_place.has_value();
  at.fits = belief_.box(item) && fit_of(item, belief_.box(item)->X_WP).is_in && who_sticks_out(item) < 0;
  at.leans = belief_.box(item) && locate(item) == Location::Container &&
             tilt_of(layout_.X_WT.inverse() * belief_.box(item)->X_WP) > limits_.tilt;
  at.lies_turned = report.angle_error > scenario_.recovery.lies_turned;
  at.can_be_picked = can_be_picked(item);
  return at;
}

void Packer::resume(const std::string& id, ItemReport& report) {
  plant_.acknowledge();
  const std::vector<motion::Waypoint> rest(last_.begin() + std::max(0, robot_.end.waypoint), last_.end());
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
  up.p_WE.z() = std::max(up.p_WE.z(), travel_bottom(layout_, obstacle_top(-1)) + hanging);
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

bool Packer::can_set_aside(int item) const {
  return is_holding() || (can_be_picked(item) && locate(item) != Location::Aligner);
}

void Packer::set_aside(int item, const Planned* planned, ItemReport& report) {
  belief_.doubt_prediction();
  let_go_ = item;
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const Pose& X_WA = scenario_.aligner->X_WA;
  const Pose& X_WP = belief_.box(item)->X_WP;
  const bool is_held = planned != nullptr && is_holding();
  const Matrix3 R_AP = is_held ? planned->attempt.planned.X_TP.R
                               : packing::rotation(packing::nearest_orientation(X_WA.R.transpose() * X_WP.R));
  Carried carried{box, X_WA.R * R_AP, Pose{}, std::nullopt};
  const Pose arrival = cell::arrival_pose(belief_.nominal(), belief_.sequence().items[static_cast<std::size_t>(item)]);
  const Vector3 aside = Vector3::Constant(scenario_.recovery.aside) + 0.5 * (R_AP.cwiseAbs() * box.size);
  skills::FlipPlace place{X_WA * aside, Vector3::UnitX()};
  place.p_WF.z() = arrival.p.z() + skills::lowest_corner(arrival.R, box.size);
  std::vector<motion::Waypoint> rows;
  if (is_held) {
    carried.X_PS = planned->attempt.X_PS;
    carried.swing = planned->attempt.swing;
    rows = {lift(carried)};
  } else {
    rows = plan_pick(belief_.nominal(), layout_, box, X_WP, {carried.R_WP, place.p_WF},
                     travel_bottom(layout_, obstacle_top(-1)), skills::PickKind::FromAfar);
    const auto pick = std::ranges::find(rows, MotionClass::RePick, &motion::Waypoint::motion_class);
    const Pose X_ES{Matrix3::Identity(), cup::pick_length(scenario_.cup) * Vector3::UnitZ()};
    carried.X_PS = X_WP.inverse() * pick->X_WE() * X_ES;
  }
  put_down(carried, place, std::move(rows), report);
}

void Packer::repack(int item, const Decide& decide, ItemReport& report) {
  ItemReport own;
  own.id = items_[static_cast<std::size_t>(item)].id;
  const std::optional<Planned> planned = plan(item, decide, own);
  report.attempts += own.attempts;
  if (!planned) {
    left_out_.insert(item);
    return;
  }
  (void)send(planned->attempt, own.id, report);
  if (robot_.end.reason != plant::EndReason::Completed) retreat(own.id, report);
  look(report);
  if (is_gone(own.id)) return;
  if (is_seen_outside(own.id)) {
    left_out_.insert(item);
  } else {
    repacked_.push_back({planned->attempt.planned, layout_.X_WT.inverse() * belief_.box(item)->X_WP});
  }
}

bool Packer::recover(int item, const Planned& planned, const std::vector<std::optional<Pose>>& before,
                     const Decide& decide, ItemReport& report) {
  int stops = 0;
  bool was_pressed = false, was_set_aside = false;
  const packing::Placement goal = planned.attempt.planned;
  Trouble trouble = find_trouble(item, goal, before, report);
  for (int round = 0; round < scenario_.recovery.most_rounds && trouble != Trouble::None; ++round) {
    if (report.sends.back().trouble == Trouble::None) report.sends.back().trouble = trouble;
    // It may be another box that sticks out: then that is pressed, or taken out and packed anew.
    const int culprit = trouble == Trouble::SticksOut ? who_sticks_out(item) : item;
    stops += trouble == Trouble::ProtectiveStop ? 1 : 0;
    Situation at = situation_of(culprit, trouble, report);
    at.stops = stops;
    at.can_set_aside = !was_set_aside && can_set_aside(culprit);
    at.was_pressed = was_pressed || (belief_.box(culprit) && is_under_obstacle(culprit));
    const Remedy remedy = choose_remedy(at, scenario_.recovery);
    const bool is_of_motion = trouble_of(robot_.end.reason) == trouble;
    std::string detail = is_of_motion ? plant::describe(robot_.end, last_) : std::string();
    if (culprit != item) detail = items_[static_cast<std::size_t>(culprit)].id;
    report.recoveries.push_back({robot_.time, report.id, trouble, remedy, std::move(detail)});
    switch (remedy) {
      case Remedy::None:
      case Remedy::Accept:
        report.end = trouble == Trouble::NeighbourMoved ? ItemEnd::Placed : ItemEnd::Accepted;
        return false;
      case Remedy::PickAgain:
        if (culprit == item) return true;
        repack(culprit, decide, report);
        was_pressed = false;
        break;
      case Remedy::SetAside:
        was_set_aside = true;
        set_aside(culprit, culprit == item ? &planned : nullptr, report);
        if (robot_.end.reason != plant::EndReason::Completed) break;
        belief_.forget(culprit);  // the next arrival takes it away
        if (culprit != item) break;
        report.end = ItemEnd::SetAside;
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
    trouble = find_trouble(item, goal, before, report);
  }
  if (trouble == Trouble::None) {
    report.end = ItemEnd::Placed;
  } else {
    give_up(item, trouble, report);
  }
  return false;
}

ItemReport Packer::bring_in(int item, const Decide& decide) {
  ItemReport report;
  report.id = items_[static_cast<std::size_t>(item)].id;
  robot_ = plant_.read();
  report.begin = robot_.time;
  if (!plant_.bring(report.id)) {
    report.end = ItemEnd::NotBrought;
    report.reason = "the plant does not bring it";
    const plant::End end = plant_.read().end;
    if (end.reason == plant::EndReason::Fault) {
      report.reason = plant::describe(end, {});
      stop_reason_ = StopReason::PlantFault;
    }
    return report;
  }
  belief_.arrives(item);
  look(report);
  if (stop_reason_) {
    report.end = ItemEnd::NotHeld;
    report.reason = name_of(*stop_reason_);
  } else if (!is_gone(report.id) && size_off(item) > scenario_.recovery.wrong_size) {
    report.recoveries.push_back({robot_.time, report.id, Trouble::WrongItem,
                                 choose_remedy({.trouble = Trouble::WrongItem}, scenario_.recovery),
                                 fmt::format("edges differ by up to {:.0f} mm", 1e3 * size_off(item))});
    report.end = ItemEnd::WrongItem;
    report.reason = report.recoveries.back().detail;
  }
  const bool is_refused = report.end == ItemEnd::WrongItem;
  bool is_whole = true;
  for (bool again = !is_refused; again && !stop_reason_;) {
    again = false;
    if (is_gone(report.id)) {
      give_up(item, Trouble::Gone, report);
      break;
    }
    const std::optional<Planned> planned = plan(item, decide, report);
    if (!planned) {
      leave(item, report);
      if (report.end == ItemEnd::Left && can_set_aside(item)) {
        set_aside(item, nullptr, report);
        if (robot_.end.reason == plant::EndReason::Completed) report.end = ItemEnd::SetAside;
      }
      break;
    }
    const std::vector<std::optional<Pose>> before = believed_poses();
    if (std::ranges::find(order_, item) == order_.end()) order_.push_back(item);
    if (!is_whole) report.sends.pop_back();  // this one takes its place
    report.sends.push_back({robot_.time, report.predicted_success, planned->attempt.planned, {}, Trouble::None});
    is_whole = send(planned->attempt, report.id, report);
    report.sends.back().end = robot_.end;
    if (!is_whole) {  // planned anew from where the box stands: the loop closed, nothing went wrong
      again = report.attempts < 3 * scenario_.rehearsal.most_attempts;
      if (again) continue;
      report.reason = "it does not come to stand as it was rehearsed";
      leave(item, report);
      break;
    }
    again = recover(item, *planned, before, decide, report);
    if (robot_.end.reason == plant::EndReason::Completed) belief_.weigh(item);
  }
  const bool is_taken_away =
      report.end == ItemEnd::NoPlace || report.end == ItemEnd::Hopeless || report.end == ItemEnd::NotHeld ||
      report.end == ItemEnd::SetAside;
  if (is_taken_away || is_refused || report.end == ItemEnd::Gone) belief_.forget(item);  // the next arrival takes it away
  if (!report.is_packed()) skipped_.push_back(report.id);
  if (report.end == ItemEnd::NoPlace) --skips_left_;
  report.done = robot_.time;
  return report;
}

void Packer::move_home(ItemReport& report) {
  const motion::Waypoint home = motion::make_waypoint(MotionClass::Home, {}, scenario_.controller.X_WE_start);
  const motion::Waypoint from = motion::make_waypoint(MotionClass::Home, {}, robot_.X_WE);
  motion::Program rows;
  append(rows, drivable(layout_, from, {home}));
  submit("", rows.waypoints, {std::nullopt, false}, report);
}

SessionFailure Packer::go_home() {
  ItemReport nobody;
  move_home(nobody);
  if (robot_.end.reason == plant::EndReason::Completed) return {};
  return {SessionFailureKind::NotHome, "on the way home: " + plant::describe(robot_.end, last_)};
}

}  // namespace snug::session
