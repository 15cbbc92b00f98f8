// Packer: the next item is brought, seen and planned while the tool leaves the one before.
#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/session/packer.hpp"

namespace snug::session {
namespace {

constexpr double kSamePosition = 0.001;  ///< m, of the tool: where it was planned from
constexpr double kSameAngle = 0.002;     ///< rad, of the tool and of joints

bool stands_as(const plant::Feedback& robot, const plant::Feedback& expected) {
  if ((robot.X_WE.p - expected.X_WE.p).norm() > kSamePosition) return false;
  if (angle_between(robot.X_WE.R, expected.X_WE.R) > kSameAngle) return false;
  return std::ranges::equal(robot.q, expected.q,
                            [](double is, double was) { return std::abs(is - was) <= kSameAngle; });
}

}  // namespace

const ComingItem* Packer::follower_of(int item) const {
  const auto found = std::ranges::find(coming_, item, &ComingItem::item);
  const bool is_repacked = handled_.size() > 1;
  return is_repacked || found == coming_.end() || found + 1 == coming_.end() ? nullptr : &*(found + 1);
}

std::optional<Pose> Packer::tool_after(int item, const packing::ContainerState& state) const {
  const ComingItem* next = follower_of(item);
  if (next == nullptr || !layout_.is_fast) return std::nullopt;
  const model::Sequence& sequence = belief_.sequence();
  const Pose X_WP = cell::arrival_pose(belief_.nominal(), sequence.items[static_cast<std::size_t>(next->item)]);
  if (!options_.ask) {  // others are asked of what is, not of what is expected
    auto decision = next->agent->decide(state, items_[static_cast<std::size_t>(next->item)]);
    if (decision) {
      const Standing box{next->item, X_WP, Location::Aligner};
      sort(box, decision->candidates);
      const auto outline = outline_of(box, decision->candidates.front().placement.orientation);
      if (outline) return outline->X_WE;
    }
  }
  return skills::tool_before_pick(belief_.nominal(), layout_,
                                  skills::make_planned_box(belief_.nominal(), sequence, next->item), X_WP,
                                  travel_bottom(layout_, obstacle_top(item)));
}

void Packer::look_ahead(Leaving& leaving, const plant::Event& event) {
  using Stage = Leaving::Stage;
  if (const auto* passed = plant::get<plant::WaypointPassed>(event)) {
    const bool is_followed = follower_of(leaving.item) != nullptr;
    if (passed->waypoint != leaving.waypoint || !is_followed) return;
    if (options_.is_interrupted && options_.is_interrupted()) return;
    plant_.perceive(belief_.expectations());
    leaving.stage = Stage::PerceivesItem;
  } else if (const auto* seen = plant::get<plant::Perceived>(event)) {
    if (leaving.stage == Stage::PerceivesItem) return bring_next(leaving, seen->observation);
    leaving.stage = Stage::Done;
    plan_next(leaving.attempt, seen->observation, event.time);
  } else if (plant::get<plant::ItemArrived>(event) != nullptr) {
    plant_.perceive(belief_.expectations());
    leaving.stage = Stage::PerceivesNext;
  } else if (plant::get<plant::FaultRaised>(event) != nullptr) {
    if (leaving.stage == Stage::BringsNext) leaving.stage = Stage::Done;
  }
}

bool Packer::take_in_if_plain(const perception::Observation& seen, const ItemReport& report) {
  const bool is_plain =
      seen.fault == perception::LookFault::None && seen.missing.empty() && !belief_.has_new_obstacle(seen);
  if (is_plain) take_in(seen, report);
  return is_plain;  // else it is looked at again when the tool stands
}

void Packer::bring_next(Leaving& leaving, const perception::Observation& seen) {
  leaving.stage = Leaving::Stage::Done;
  if (!take_in_if_plain(seen, leaving.report)) return;
  if (assess(leaving.item, leaving.attempt.planned, leaving.before, leaving.report) != Trouble::None) return;
  const ComingItem& next = *follower_of(leaving.item);
  const std::string& id = items_[static_cast<std::size_t>(next.item)].id;
  if (!plant_.bring(model::ParcelId(id))) return;
  leaving.stage = Leaving::Stage::BringsNext;
  belief_.weigh(leaving.item);
  belief_.arrives(next.item);
  ahead_.emplace(next.item, id);
}

void Packer::plan_next(const Attempt& attempt, const perception::Observation& seen, double time) {
  Ahead& ahead = *ahead_;
  ahead.is_seen = take_in_if_plain(seen, ahead.report);
  if (!ahead.is_seen || is_gone(ahead.report.id) || is_wrong(ahead.item)) return;
  const ComingItem& next = *std::ranges::find(coming_, ahead.item, &ComingItem::item);
  ahead.since = time;
  ahead.robot.X_WE = attempt.program.waypoints.back().X_WE;
  ahead.robot.q = attempt.q_end;
  ahead.planning = std::async(std::launch::async, [this, agent = next.agent] {
    return plan(ahead_->item, *agent, ahead_->robot, ahead_->report);
  });
}

void Packer::finish_planning_ahead() {
  if (!ahead_) return;
  if (robot_.end.reason != plant::EndReason::Completed) ahead_->is_seen = false;
  if (!ahead_->planning.valid()) return;
  ahead_->planned = ahead_->planning.get();
  ItemReport& report = ahead_->report;
  const double planning = report.decision_seconds + report.rehearsal_seconds;
  report.planning_wait = std::max(0.0, planning - (robot_.time - ahead_->since));
  if (robot_.end.reason == plant::EndReason::Completed && stands_as(robot_, ahead_->robot)) return;
  ahead_->planned.reset();
  ItemReport anew;
  anew.id = report.id;
  anew.planning_wait = report.planning_wait;
  report = std::move(anew);
}

}  // namespace snug::session
