// Rehearsal: one item's motions tried in the nominal world and in the sampled ones before they are sent.
#include "snug/session/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/parallel.hpp"

namespace snug::session {
namespace {

/// Along the floor.
double level_distance(const Pose& X, const Pose& X_planned) { return (X.p - X_planned.p).head<2>().norm(); }

/// Whether a point is not over the floor of the container.
bool is_beside(const Vector3& inner, const Vector3& p_T) {
  return std::abs(p_T.x()) > 0.5 * inner.x() || std::abs(p_T.y()) > 0.5 * inner.y();
}

std::string describe_outside(const cell::ContainerFit& fit, bool is_beside, double off) {
  return is_beside ? fmt::format("it would be left beside the container, {:.0f} mm from its place", 1e3 * off)
                   : fmt::format("it would stick out ({:.0f} mm beyond a wall, {:.0f} mm over the rim)",
                                 1e3 * fit.outside, 1e3 * fit.above_rim);
}

}  // namespace

Rehearsal::Rehearsal(Belief& belief, const skills::CellLayout& layout, const ToolReach& reaches,
                     const settings::PlaceLimits& limits, int threads, const RehearsalTask& task)
    : belief_(belief),
      layout_(layout),
      reaches_(reaches),
      limits_(limits),
      threads_(threads),
      task_(task),
      box_(skills::make_planned_box(belief.nominal(), belief.sequence(), task.item)),
      rollouts_(belief.take_up(task.robot)) {
  for (const auto& rollout : rollouts_) {
    states_.push_back(rollout->state());
    before_.push_back(rollout->poses());
  }
}

Rehearsal::Outcome Rehearsal::judge(const Rollout& rollout, const std::vector<std::optional<Pose>>& before,
                                    const Pose& X_TP) const {
  Outcome outcome;
  const auto fail = [&outcome](AttemptFailure failure, std::string text) {
    if (outcome.failure != AttemptFailure::None) return;
    outcome.failure = failure;
    outcome.text = std::move(text);
  };
  const model::Scenario& scenario = rollout.simulation().scenario();
  const Vector3 inner = model::find_container(scenario, scenario.target)->inner_size;
  const Pose X_TW = layout_.X_WT.inverse();
  const auto fit_of = [&](int item, const Pose& X_WP) {
    const std::string& id = rollout.simulation().sequence().items[static_cast<std::size_t>(item)].parcel;
    return cell::fit_in(inner, model::collision_size(scenario, *model::find_parcel(scenario, id)), X_TW * X_WP);
  };
  const std::optional<Pose> X_WP = rollout.pose_of(box_.item);
  if (!X_WP) {
    fail(AttemptFailure::Gone, "it is gone");
    return outcome;
  }
  const Pose X_TP_is = X_TW * *X_WP;
  const cell::ContainerFit fit = fit_of(box_.item, *X_WP);
  const double off = level_distance(X_TP_is, X_TP), turned = angle_between(X_TP_is.R, X_TP.R);
  if (rollout.is_held(box_.item)) {
    fail(AttemptFailure::SticksOut, "it still hangs from the cup");
  } else if (!fit.is_in) {
    fail(AttemptFailure::SticksOut, describe_outside(fit, is_beside(inner, X_TP_is.p), off));
  }
  if (off > limits_.position) fail(AttemptFailure::OffPlace, fmt::format("{:.0f} mm from its place", 1e3 * off));
  if (turned > limits_.tilt) {
    fail(AttemptFailure::Tilted, fmt::format("{:.0f} degrees from its place", turned * 180.0 / std::numbers::pi));
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int item = static_cast<int>(i);
    if (!before[i] || item == box_.item) continue;
    const std::optional<Pose> after = rollout.pose_of(item);
    if (after) outcome.forces.displacement = std::max(outcome.forces.displacement, (after->p - before[i]->p).norm());
    if (fit_of(item, *before[i]).is_in && !(after && fit_of(item, *after).is_in)) {
      fail(AttemptFailure::OthersCameOut, "another box would come out of the container");
    }
  }
  if (outcome.forces.displacement > limits_.displacement) {
    fail(AttemptFailure::OthersMoved,
         fmt::format("another box would move {:.0f} mm", 1e3 * outcome.forces.displacement));
  }
  return outcome;
}

const Grasp& Rehearsal::grasp_for(const packing::Placement& placement, double packed_top) {
  for (const Grasp& known : grasps_) {
    if (known.orientation == placement.orientation) return known;
  }
  const motion::Waypoint from = motion::make_waypoint(motion::MotionClass::Home, {}, task_.robot.X_WE, task_.robot.io);
  grasps_.push_back(plan_grasp({belief_.nominal(), layout_, rollouts_, states_, belief_.weights(), from, box_,
                                task_.X_WP, task_.location, packed_top, threads_, reaches_},
                               placement.orientation));
  return grasps_.back();
}

/// All samples, or the first alone where most of these fail: the rate of such an attempt is below what is ever sent.
void Rehearsal::rehearse_samples(const std::function<Outcome(int)>& execute, Attempt& attempt) const {
  const settings::RehearsalSettings& settings = belief_.nominal().rehearsal;
  const int all = static_cast<int>(rollouts_.size()) - 1;
  std::vector<Outcome> outcomes(static_cast<std::size_t>(all));
  const auto rehearse = [&](int first, int last) {
    parallel_for(last - first, threads_,
                 [&](int i, int) { outcomes[static_cast<std::size_t>(first + i)] = execute(first + i + 1); });
    attempt.samples = last;
  };
  double good = 0.0, weight = 0.0;
  const auto count = [&] {
    good = weight = 0.0;
    for (int i = 0; i < attempt.samples; ++i) {
      const double own = belief_.weights()[static_cast<std::size_t>(i) + 1];
      weight += own;
      if (outcomes[static_cast<std::size_t>(i)].failure == AttemptFailure::None) good += own;
    }
    attempt.success_rate = weight > 0.0 ? good / weight : 1.0;
  };
  const int first = std::min(all, settings.first_samples);
  rehearse(0, first);
  count();
  if (attempt.success_rate >= 0.5 * settings.least_rate && first < all) {
    rehearse(first, all);
    count();
  }
  for (int i = 0; i < attempt.samples; ++i) {
    const Outcome& outcome = outcomes[static_cast<std::size_t>(i)];
    if (attempt.failure == AttemptFailure::None) {
      attempt.failure = outcome.failure;
      attempt.text = outcome.text;
    }
    attempt.predicted.force = std::max(attempt.predicted.force, outcome.forces.force);
    attempt.predicted.torque = std::max(attempt.predicted.torque, outcome.forces.torque);
    attempt.predicted.displacement = std::max(attempt.predicted.displacement, outcome.forces.displacement);
  }
}

/// Rows to RehearsalTask::X_WE_after; none where the robot cannot follow them.
std::vector<motion::Waypoint> Rehearsal::way_to_next(const motion::Waypoint& last) const {
  if (!task_.X_WE_after) return {};
  const motion::Waypoint away =
      motion::make_waypoint(motion::MotionClass::PostPlace, box_.id, *task_.X_WE_after, {}, "_away");
  auto rows = drivable(layout_, last, {away});
  if (!can_follow(reaches_, layout_, last, rows)) rows.clear();
  return rows;
}

Attempt Rehearsal::attempt(const packing::Candidate& candidate, const skills::Insertion& insertion, double packed_top) {
  Attempt attempt;
  attempt.planned = candidate.placement;
  attempt.skill = insertion.skill;
  const std::size_t known = grasps_.size();
  const Grasp& grasp = grasp_for(candidate.placement, packed_top);
  attempt.was_rehearsed = grasp.problem == GraspProblem::None || grasps_.size() > known;
  if (grasp.problem != GraspProblem::None) {
    const Episode& nominal = grasp.episodes[0];
    attempt.failure = AttemptFailure::Grasp;
    attempt.text = nominal.is_complete() ? describe(grasp.problem) : nominal.text;
    attempt.was_stopped = nominal.end == RolloutEnd::ProtectiveStop;
    return attempt;
  }
  attempt.reorientation = grasp.reorientation;
  attempt.planned.orientation = grasp.held_as;
  attempt.planned.X_TP.R = packing::rotation(grasp.held_as);
  attempt.program = grasp.program;
  attempt.looks = grasp.looks;
  attempt.looked = grasp.seen;
  attempt.X_PS = grasp.X_PS;
  attempt.swing = grasp.swing;
  const motion::Waypoint& last = attempt.program.waypoints.back();
  const skills::PlaceRequest request{box_,      grasp.X_PS, attempt.planned.X_TP, insertion, packed_top,
                                     last.X_WE, grasp.X_EP};
  auto rows = drivable(layout_, last, plan_place(belief_.nominal(), layout_, request), grasp.swing);
  if (!can_follow(reaches_, layout_, last, rows)) {
    attempt.failure = AttemptFailure::OutOfReach;
    attempt.text = "the robot cannot follow the way to its place";
    return attempt;
  }
  if (const auto away = way_to_next(rows.back()); !away.empty()) {
    attempt.leaves = attempt.program.waypoints.size() + rows.size() - 1;
    rows.insert(rows.end(), away.begin(), away.end());
  }
  append(attempt.program, rows);
  attempt.ends.resize(rollouts_.size());
  const auto execute = [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    Rollout& rollout = *rollouts_[i];
    rollout.restore(grasp.states[i]);
    Episode episode = grasp.episodes[i];
    motion::Program program = grasp.programs[i];
    append(program, rows);
    merge(episode, rollout.run(program, {limits_.force, false}));
    if (episode.is_complete()) merge(episode, rollout.settle(program, belief_.nominal().rehearsal.rest));
    Outcome outcome = judge(rollout, before_[i], attempt.planned.X_TP);
    outcome.end = episode.end;
    outcome.forces.force = episode.peak_force;
    outcome.forces.torque = episode.peak_torque;
    if (!episode.is_complete() || !episode.arm_contact.empty()) {  // also while boxes came to rest
      outcome.failure = AttemptFailure::Rollout;
      outcome.text = episode.is_complete() ? episode.arm_contact : episode.text;
    }
    const double hold_factor = rollout.state().gripper.least_hold_factor;
    if (outcome.failure == AttemptFailure::None && hold_factor < limits_.hold_factor) {
      outcome.failure = AttemptFailure::HoldMargin;
      outcome.text = fmt::format("the cup would hold only {:.1f} times its load", hold_factor);
    }
    attempt.ends[i] = rollout.poses();
    return outcome;
  };
  const Outcome nominal = execute(0);
  attempt.failure = nominal.failure;
  attempt.text = nominal.text;
  attempt.succeeded = nominal.failure == AttemptFailure::None;
  attempt.was_stopped = nominal.end == RolloutEnd::ProtectiveStop;
  attempt.nominal = nominal.forces;
  if (const auto& arm = rollouts_[0]->state().arm) {
    attempt.q_end.assign(arm->machine.joints.q.begin(), arm->machine.joints.q.end());
  }
  if (attempt.succeeded) rehearse_samples(execute, attempt);
  return attempt;
}

}  // namespace snug::session
