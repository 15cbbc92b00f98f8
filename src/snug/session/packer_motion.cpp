// Packer: motions sent, and what they came to.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/core/stopwatch.hpp"
#include "snug/plant/wait.hpp"
#include "snug/session/packer.hpp"

namespace snug::session {
namespace {

using motion::MotionClass;

/// m, what a look may be off: two standard deviations.
double slack_of(const BelievedBox& box) { return 2.0 * std::sqrt(std::max(0.0, box.covariance(0, 0))); }

}  // namespace

std::optional<Pose> Packer::pose_of(int item) const {
  return belief_.box(item) ? std::optional<Pose>(belief_.box(item)->X_WP) : std::nullopt;
}

std::vector<std::optional<Pose>> Packer::believed_poses() const {
  std::vector<std::optional<Pose>> poses;
  for (int i = 0; i < static_cast<int>(items_.size()); ++i) {
    poses.push_back(pose_of(i));
  }
  return poses;
}

void Packer::submit(const std::string& id, std::vector<motion::Waypoint> waypoints, const plant::Guards& guards,
                    ItemReport& report, Leaving* leaving) {
  last_ = std::move(waypoints);
  sent_.waypoints.insert(sent_.waypoints.end(), last_.begin(), last_.end());
  plant::Motion motion{model::ParcelId(id), last_, guards, {}};
  if (leaving != nullptr) motion.perceive_after = leaving->waypoint;
  plant_.start(motion);
  bool has_ended = false;
  const auto is_busy = [&] {
    return leaving != nullptr && leaving->stage != Leaving::Stage::Inserts && leaving->stage != Leaving::Stage::Done;
  };
  while (!has_ended || is_busy()) {
    for (const plant::Event& event : plant_.advance()) {
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) {
        robot_ = ended->feedback;
        has_ended = true;
      }
      if (leaving != nullptr) look_ahead(*leaving, event);
    }
  }
  finish_planning_ahead();
  report.seconds += split_seconds(last_, robot_.times);
  report.happened.force = std::max(report.happened.force, robot_.peak_force);
  report.happened.torque = std::max(report.happened.torque, robot_.peak_torque);
}

bool Packer::was_stopped_by_load() const {
  const plant::EndReason reason = robot_.end.reason;
  const bool is_of_load = reason == plant::EndReason::ForceGuard || reason == plant::EndReason::VacuumLost ||
                          reason == plant::EndReason::HoldGuard || reason == plant::EndReason::ProtectiveStop;
  if (!is_of_load || !robot_.end.waypoint) return false;
  const MotionClass at = last_[robot_.end.waypoint->slot()].motion_class;
  return at == MotionClass::Place || at == MotionClass::PlaceSlow;
}

bool Packer::send(const Attempt& attempt, const std::vector<std::optional<Pose>>& before, ItemReport& report) {
  const auto& all = attempt.program.waypoints;
  const int item = index_of(report.id);
  std::size_t begin = 0;
  for (std::size_t stage = 0; stage <= attempt.looks.size(); ++stage) {
    const bool is_last = stage == attempt.looks.size();
    const std::size_t end = is_last ? all.size() : attempt.looks[stage];
    std::optional<Leaving> leaving;
    if (is_last) {
      belief_.expect(attempt.ends);
      if (attempt.leaves) {
        leaving.emplace(Leaving{item, attempt, before, report, motion::WaypointIndex(*attempt.leaves - begin)});
      }
    } else {
      belief_.expect_on_the_way(item, attempt.looked[stage]);
    }
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
    submit(report.id, {first, all.begin() + static_cast<std::ptrdiff_t>(end)},
           {limits_.force, true, limits_.hold_guard}, report, leaving ? &*leaving : nullptr);
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

bool Packer::is_handled(int item) const { return std::ranges::find(handled_, item) != handled_.end(); }

int Packer::who_sticks_out(int item) const {
  const auto is_out = [&](int one) {
    return !left_out_.contains(one) && is_seen_outside(items_[static_cast<std::size_t>(one)].id);
  };
  for (const int other : order_) {
    if (is_handled(other) || !belief_.box(other)) continue;
    if (locate(other) == Location::Container && is_out(other)) return other;
  }
  return is_out(item) ? item : -1;
}

double Packer::moved(int item, const std::vector<std::optional<Pose>>& before) const {
  const std::optional<Pose>& was = before[static_cast<std::size_t>(item)];
  const std::optional<BelievedBox>& box = belief_.box(item);
  if (!was || !box || !box->was_seen) return 0.0;
  return std::max(0.0, (box->X_WP.p - was->p).norm() - slack_of(*box));
}

bool Packer::was_lifted(int item, const std::vector<std::optional<Pose>>& before) const {
  const std::optional<Pose>& was = before[static_cast<std::size_t>(item)];
  return was && belief_.box(item) && belief_.box(item)->X_WP.p.z() > was->p.z() + limits_.displacement;
}

int Packer::who_was_moved(int item, const std::vector<std::optional<Pose>>& before) const {
  int highest = -1;
  for (const int other : order_) {
    if (other == item || is_handled(other) || moved(other, before) <= limits_.displacement) continue;
    if (highest < 0 || belief_.box(other)->X_WP.p.z() > belief_.box(highest)->X_WP.p.z()) highest = other;
  }
  return highest;
}

double Packer::tilt_of(int item) const {
  const Matrix3 R_TP = layout_.X_WT.R.transpose() * belief_.box(item)->X_WP.R;
  return std::acos(std::min(1.0, R_TP.row(2).cwiseAbs().maxCoeff()));
}

Trouble Packer::assess(int item, const packing::Placement& planned, const std::vector<std::optional<Pose>>& before,
                       ItemReport& report) const {
  const std::optional<BelievedBox>& box = belief_.box(item);
  if (!box) return Trouble::Gone;
  const Pose X_TP = layout_.X_WT.inverse() * box->X_WP;
  report.X_TP = X_TP;
  report.position_error = (X_TP.p - planned.X_TP.p).head<2>().norm();
  report.angle_error = angle_between(X_TP.R, planned.X_TP.R);
  for (const int other : order_) {
    if (other != item) report.happened.displacement = std::max(report.happened.displacement, moved(other, before));
  }
  if (locate(item) != Location::Container) return Trouble::OffPlace;  // nothing there is to be pressed on
  const int neighbour = who_was_moved(item, before);
  const bool may_lie_on_it = neighbour >= 0 && belief_.box(neighbour)->X_WP.p.z() > box->X_WP.p.z();
  const bool is_off_place = report.position_error > limits_.position || report.angle_error > limits_.tilt;
  if (may_lie_on_it && is_off_place) return Trouble::NeighbourMoved;
  if (tilt_of(item) > limits_.tilt) return Trouble::Leaning;
  if (who_sticks_out(item) >= 0) return Trouble::SticksOut;
  if (is_off_place) return Trouble::OffPlace;
  return neighbour >= 0 ? Trouble::NeighbourMoved : Trouble::None;
}

bool Packer::is_holding() const {
  return robot_.io.vacuum &&
         robot_.pressure_gauge < scenario_.motion_guards.needed_vacuum * scenario_.cup.vacuum.pressure_gauge_hold;
}

void Packer::refuse(int item, ItemReport& report) const {
  report.recoveries.push_back({robot_.time, report.id, Trouble::WrongItem,
                               choose_remedy({.trouble = Trouble::WrongItem}, scenario_.recovery),
                               fmt::format("edges differ by up to {:.0f} mm", 1e3 * size_off(item))});
  report.end = ItemEnd::WrongItem;
  report.reason = report.recoveries.back().detail;
}

ItemReport Packer::bring_in(int item, packing::Agent& agent) {
  ItemReport report;
  report.id = items_[static_cast<std::size_t>(item)].id;
  std::optional<PlanResult> planned;
  std::optional<Ahead> ahead = std::exchange(ahead_, std::nullopt);
  if (ahead && ahead->item != item) ahead.reset();
  robot_ = plant_.read();
  if (ahead) {
    report = std::move(ahead->report);
    planned = std::move(ahead->planned);
  }
  report.begin = robot_.time;
  if (!ahead && !plant::bring_and_wait(plant_, model::ParcelId(report.id))) {
    report.end = ItemEnd::NotBrought;
    report.reason = "the plant does not bring it";
    const plant::End end = plant_.read().end;
    if (end.reason == plant::EndReason::Fault) {
      report.reason = plant::describe(end, {});
      stop_reason_ = StopReason::PlantFault;
    }
    return report;
  }
  if (!ahead) belief_.arrives(item);
  if (!ahead || !ahead->is_seen) look(report);
  if (stop_reason_) {
    report.end = ItemEnd::NotHeld;
    report.reason = name_of(*stop_reason_);
  } else if (is_wrong(item)) {
    refuse(item, report);
  }
  const bool is_refused = report.end == ItemEnd::WrongItem;
  if (!is_refused) bring_to_place(item, agent, std::move(planned), report);
  const bool is_taken_away = report.end == ItemEnd::NoPlace || report.end == ItemEnd::Hopeless ||
                             report.end == ItemEnd::NotHeld || report.end == ItemEnd::Returned;
  if (is_taken_away || is_refused || report.end == ItemEnd::Gone)
    belief_.forget(item);  // the next arrival takes it away
  if (!report.is_packed()) skipped_.push_back(report.id);
  if (report.end == ItemEnd::NoPlace) --skips_left_;
  report.done = robot_.time;
  return report;
}

void Packer::bring_to_place(int item, packing::Agent& agent, std::optional<PlanResult> ready, ItemReport& report) {
  handled_.push_back(item);
  bool is_whole = true, again = true;
  while (again && !stop_reason_) {
    again = false;
    if (is_gone(report.id)) {
      give_up(item, Trouble::Gone, report);
      break;
    }
    if (!ready) {
      const auto start = std::chrono::steady_clock::now();
      ready = plan(item, agent, robot_, report);
      report.planning_wait += seconds_since(start);
    }
    const PlanResult planned = std::move(*std::exchange(ready, std::nullopt));
    if (!planned) {
      leave(item, report);
      if (report.end == ItemEnd::Left && can_return(item)) {
        return_to_aligner(item, nullptr, report);
        if (robot_.end.reason == plant::EndReason::Completed) report.end = ItemEnd::Returned;
      }
      break;
    }
    const std::vector<std::optional<Pose>> before = believed_poses();
    if (std::ranges::find(order_, item) == order_.end()) order_.push_back(item);
    if (!is_whole) report.sends.pop_back();  // this one takes its place
    report.sends.push_back({robot_.time, report.predicted_success, planned->attempt.planned, {}, Trouble::None});
    is_whole = send(planned->attempt, before, report);
    report.sends.back().end = robot_.end;
    if (!is_whole) {  // planned anew from where the box stands: the loop closed, nothing went wrong
      again = report.attempts < 3 * scenario_.rehearsal.most_attempts;
      if (again) continue;
      report.reason = "it does not come to stand as it was rehearsed";
      leave(item, report);
      break;
    }
    if (ahead_ && robot_.end.reason == plant::EndReason::Completed) {
      report.end = ItemEnd::Placed;
      break;
    }
    again = recover(item, *planned, before, agent, report);
    if (robot_.end.reason == plant::EndReason::Completed) belief_.weigh(item);
  }
  if (again) {  // the session ends before it is planned once more
    leave(item, report);
    report.reason = name_of(*stop_reason_);
  }
  handled_.pop_back();
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
