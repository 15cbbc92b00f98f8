// Executor: tries to bring a box to its place, in the course of events that counts and in those that could be.
#include "snug/task/executor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/core/parallel.hpp"
#include "snug/task/reach.hpp"

namespace snug::task {
namespace {

constexpr double kRest = 0.4;  ///< s, after the last row, before the result is looked at

/// From where a box was planned, along the floor.
double level_distance(const Pose& X, const Pose& X_planned) { return (X.p - X_planned.p).head<2>().norm(); }

}  // namespace

Executor::Executor(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options)
    : scenario_(scenario), options_(options), layout_(make_layout(scenario)), reaches_(make_tool_reach(scenario)) {
  lanes_.push_back(std::make_unique<Lane>(scenario, sequence, options.simulation));
  const Rng rng(options.packing.seed);
  for (int i = 0; i < options.samples; ++i) {
    const Rng own = rng.split("sample " + std::to_string(i));
    lanes_.push_back(
        std::make_unique<Lane>(sample(scenario, sequence, options.uncertainty, own), sequence, options.simulation));
  }
  for (const auto& lane : lanes_) states_.push_back(lane->state());
  program_.name = "pack";
}

void Executor::begin(int item) {
  box_ = make_planned_box(scenario_, lanes_[0]->simulation().sequence(), item);
  grasps_.clear();
}

std::vector<std::optional<Pose>> Executor::poses(const Lane& lane) const {
  std::vector<std::optional<Pose>> poses;
  const auto count = lane.simulation().sequence().items.size();
  for (std::size_t i = 0; i < count; ++i) poses.push_back(lane.pose_of(static_cast<int>(i)));
  return poses;
}

Executor::Outcome Executor::judge(const Lane& lane, const std::vector<std::optional<Pose>>& before,
                                  const Pose& X_TP) const {
  Outcome outcome;
  const std::string& id = lane.simulation().sequence().items[static_cast<std::size_t>(box_.item)].parcel;
  const std::optional<Pose> X_WP = lane.pose_of(box_.item);
  if (!X_WP) {
    outcome.reason = "it is gone";
    return outcome;
  }
  const Pose X_TP_is = layout_.X_WT.inverse() * *X_WP;
  outcome.position_error = level_distance(X_TP_is, X_TP);
  outcome.angle_error = angle_between(X_TP_is.R, X_TP.R);
  bool all_in = true, is_in = false;
  const std::vector<cell::BoxResult> boxes = lane.simulation().boxes(lane.state());
  for (const cell::BoxResult& box : boxes) {
    const bool packed = box.state == cell::BoxState::Packed;
    if (box.id == id) {
      is_in = packed;
      if (!packed) {
        outcome.reason = fmt::format("{} ({:.0f} mm beyond a wall, {:.0f} mm over the rim)", cell::name_of(box.state),
                                     1e3 * box.outside, 1e3 * box.above_rim);
      }
    } else if (!packed && box.state != cell::BoxState::Waiting) {
      all_in = false;
    }
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!before[i] || static_cast<int>(i) == box_.item) continue;
    const std::optional<Pose> after = lane.pose_of(static_cast<int>(i));
    if (after) outcome.forces.displacement = std::max(outcome.forces.displacement, (after->p - before[i]->p).norm());
  }
  const PlaceLimits& limits = options_.limits;
  if (is_in && outcome.position_error > limits.position) {
    outcome.reason = fmt::format("{:.0f} mm from its place", 1e3 * outcome.position_error);
  } else if (is_in && outcome.angle_error > limits.tilt) {
    outcome.reason = fmt::format("{:.0f} degrees from its place", outcome.angle_error * 180.0 / std::numbers::pi);
  } else if (is_in && outcome.forces.displacement > limits.displacement) {
    outcome.reason = fmt::format("another box moved {:.0f} mm", 1e3 * outcome.forces.displacement);
  } else if (is_in && !all_in) {
    outcome.reason = "another box came out of the container";
  }
  outcome.succeeded = outcome.reason.empty();
  return outcome;
}

const Grasp& Executor::grasp_for(const packing::Placement& placement, double packed_top) {
  for (const Grasp& known : grasps_) {
    if (known.orientation == placement.orientation) return known;
  }
  grasps_.push_back(
      plan_grasp({scenario_, layout_, lanes_, states_, program_, box_, packed_top, options_.threads, reaches_},
                 placement.orientation));
  return grasps_.back();
}

Attempt Executor::attempt(const packing::Candidate& candidate, const PlaceVariant& variant, double packed_top) {
  Attempt attempt;
  attempt.planned = candidate.placement;
  attempt.manner = variant.manner;
  const std::size_t known = grasps_.size();
  const Grasp& grasp = grasp_for(candidate.placement, packed_top);
  attempt.was_simulated = grasp.problem.empty() || grasps_.size() > known;
  if (!grasp.problem.empty()) {
    attempt.reason = grasp.problem;
    attempt.was_stopped = grasp.episodes[0].was_stopped;
    return attempt;
  }
  attempt.turn = grasp.turn;
  attempt.planned.orientation = grasp.held_as;
  attempt.planned.X_TP.R = packing::rotation(grasp.held_as);
  attempt.program = grasp.program;
  const PlaceRequest request{box_, grasp.X_PS, attempt.planned.X_TP, variant, packed_top};
  append(attempt.program, drivable(layout_, attempt.program, plan_place(scenario_, layout_, request)));
  const std::size_t count = lanes_.size();
  std::vector<Outcome> outcomes(count);
  const auto execute = [&](int lane_index) {
    const auto i = static_cast<std::size_t>(lane_index);
    Lane& lane = *lanes_[i];
    lane.restore(states_[i]);
    const auto before = poses(lane);
    lane.restore(grasp.states[i]);
    Episode episode = grasp.episodes[i];
    merge(episode, lane.run(attempt.program, {options_.limits.force, false}));
    const cell::CellState end = lane.state();
    if (episode.failure.empty()) merge(episode, lane.settle(attempt.program, kRest));
    outcomes[i] = judge(lane, before, attempt.planned.X_TP);
    outcomes[i].forces.force = episode.peak_force;
    outcomes[i].forces.torque = episode.peak_torque;
    outcomes[i].was_stopped = episode.was_stopped;
    if (episode.failure.empty()) episode.failure = episode.arm_contact;  // while boxes came to rest
    if (!episode.failure.empty()) outcomes[i].reason = episode.failure;
    outcomes[i].succeeded = outcomes[i].reason.empty();
    lane.restore(end);
  };
  execute(0);
  attempt.succeeded = outcomes[0].succeeded;
  attempt.reason = outcomes[0].reason;
  attempt.was_stopped = outcomes[0].was_stopped;
  attempt.happened = outcomes[0].forces;
  attempt.position_error = outcomes[0].position_error;
  attempt.angle_error = outcomes[0].angle_error;
  if (!attempt.succeeded) return attempt;
  parallel_for(static_cast<int>(count) - 1, options_.threads, [&](int i, int) { execute(i + 1); });
  int good = 0;
  for (std::size_t i = 1; i < count; ++i) {
    good += outcomes[i].succeeded ? 1 : 0;
    if (attempt.reason.empty()) attempt.reason = outcomes[i].reason;
    attempt.predicted.force = std::max(attempt.predicted.force, outcomes[i].forces.force);
    attempt.predicted.torque = std::max(attempt.predicted.torque, outcomes[i].forces.torque);
    attempt.predicted.displacement = std::max(attempt.predicted.displacement, outcomes[i].forces.displacement);
  }
  attempt.share = count > 1 ? static_cast<double>(good) / static_cast<double>(count - 1) : 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    attempt.states.push_back(lanes_[i]->state());
    attempt.is_sound.push_back(outcomes[i].succeeded);
  }
  return attempt;
}

void Executor::take(Attempt attempt) {
  program_ = std::move(attempt.program);
  states_ = std::move(attempt.states);
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    // A course of events in which this box was lost says nothing about the next ones: it goes on as if it had not been.
    if (i > 0 && !attempt.is_sound[i]) {
      states_[i] = lanes_[i]->simulation().adopt(lanes_[0]->simulation(), states_[0]);
    }
    lanes_[i]->restore(states_[i]);
  }
}

Episode Executor::finish() {
  if (program_.waypoints.empty()) return {};
  motion::Waypoint home;
  home.X_WE = lanes_[0]->simulation().scenario().controller.X_WE_start;  // of the arm, where there is one
  home.name = "home";
  append(program_, drivable(layout_, program_, {home}));
  Lane& lane = *lanes_[0];
  lane.restore(states_[0]);
  Episode episode = lane.run(program_, {.arm_may_touch = true});  // nothing else is left to try: it is reported
  // As a run of the whole program does: one second after the tick in which it ends.
  if (episode.failure.empty()) merge(episode, lane.settle(program_, 0.5 * scenario_.controller.tick));
  episode.duration = lane.time();
  if (episode.failure.empty()) (void)lane.settle(program_, 1.0);
  return episode;
}

}  // namespace snug::task
