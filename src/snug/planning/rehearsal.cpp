// Rehearsal: one item's motions tried in the nominal world and in the sampled ones before they are sent.
#include "snug/planning/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/parallel.hpp"
#include "snug/packing/load_check.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::planning {
namespace {

constexpr double kSamePlace = 0.004;  ///< m: places that are nearer are planned as the same

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

/// Robots of fewer than six joints (palletisers, SCARA, gantries) turn their tool about the vertical alone.
bool is_always_upright(const model::Scenario& scenario) {
  constexpr std::size_t kJointsOfAnyPose = 6;
  return scenario.robot && !scenario.robot->posture.empty() && scenario.robot->posture.size() < kJointsOfAnyPose;
}

/// Turns the tool upright, by the smallest angle, about its lip `length` [m] below E: a box that hangs a little askew
/// because its centre of mass is beside the cup is then set down so, instead of by a tool that is tilted against it.
/// Ways that tilt the tool by more than that are left as they are: the robot cannot follow them.
void make_upright(std::vector<motion::Waypoint>& rows, double length) {
  constexpr double kMostSag = 0.1;  // rad
  for (motion::Waypoint& row : rows) {
    const Vector3 z = row.X_WE.R.col(2);
    const Quaternion upright = rotation_between(z, -Vector3::UnitZ());
    if (std::acos(std::clamp(-z.z(), -1.0, 1.0)) > kMostSag) continue;
    row.X_WE.R = upright.toRotationMatrix() * row.X_WE.R;
    row.X_WE.p += length * (z + Vector3::UnitZ());
  }
}

}  // namespace

const char* name_of(AttemptFailure failure) {
  switch (failure) {
    case AttemptFailure::None:
      return "none";
    case AttemptFailure::Grasp:
      return "grasp";
    case AttemptFailure::OutOfReach:
      return "out of reach";
    case AttemptFailure::Rollout:
      return "rollout";
    case AttemptFailure::HoldMargin:
      return "hold margin";
    case AttemptFailure::Gone:
      return "gone";
    case AttemptFailure::SticksOut:
      return "sticks out";
    case AttemptFailure::OffPlace:
      return "off its place";
    case AttemptFailure::Tilted:
      return "tilted";
    case AttemptFailure::OthersMoved:
      return "others moved";
    case AttemptFailure::OthersCameOut:
      return "others came out";
    case AttemptFailure::SentBefore:
      return "sent before";
  }
  return "";
}

Rehearsal::Rehearsal(const BeliefSnapshot& belief, const CellPlan& cell,
                     std::span<const std::unique_ptr<Rollout>> rollouts, int threads, const RehearsalTask& task)
    : belief_(belief),
      cell_(cell),
      threads_(threads),
      task_(task),
      box_(Scene{belief, cell}.planned_box(task.item)),
      rollouts_(rollouts) {
  for (const World& world : belief.worlds) weights_.push_back(world.weight);
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
  const Pose X_TW = cell_.layout.X_WT.inverse();
  const auto fit_of = [&](model::ItemIndex item, const Pose& X_WP) {
    const std::string& id = rollout.simulation().sequence().items[item.slot()].parcel;
    return cell::fit_in(inner, model::collision_size(scenario, *model::find_parcel(scenario, id)), X_TW * X_WP);
  };
  const std::optional<Pose> X_WP = rollout.pose_of(box_.item);
  if (!X_WP) {
    fail(AttemptFailure::Gone, "it is gone");
    return outcome;
  }
  const Pose X_TP_is = X_TW * *X_WP;
  // What sticks out more would be rejected with the finished load.
  const auto is_in = [](const cell::ContainerFit& fit) {
    return fit.is_in && fit.above_rim <= packing::LoadLimits{}.above;
  };
  const cell::ContainerFit fit = fit_of(box_.item, *X_WP);
  const double off = level_distance(X_TP_is, X_TP), turned = angle_between(X_TP_is.R, X_TP.R);
  if (rollout.is_held(box_.item)) {
    fail(AttemptFailure::SticksOut, "it still hangs from the cup");
  } else if (!is_in(fit)) {
    fail(AttemptFailure::SticksOut, describe_outside(fit, is_beside(inner, X_TP_is.p), off));
  }
  if (off > cell_.limits.position) fail(AttemptFailure::OffPlace, fmt::format("{:.0f} mm from its place", 1e3 * off));
  if (turned > cell_.limits.tilt) {
    fail(AttemptFailure::Tilted, fmt::format("{:.0f} degrees from its place", turned * 180.0 / std::numbers::pi));
  }
  double tipped = 0.0;  // rad, of another box
  for (std::size_t i = 0; i < before.size(); ++i) {
    const model::ItemIndex item(i);
    if (!before[i] || item == box_.item) continue;
    const std::optional<Pose> after = rollout.pose_of(item);
    if (after) outcome.forces.displacement = std::max(outcome.forces.displacement, (after->p - before[i]->p).norm());
    if (after) tipped = std::max(tipped, packing::lean_of(after->R) - packing::lean_of(before[i]->R));
    if (is_in(fit_of(item, *before[i])) && !(after && is_in(fit_of(item, *after)))) {
      fail(AttemptFailure::OthersCameOut, "another box would come out of the container");
    }
  }
  if (outcome.forces.displacement > cell_.limits.displacement) {
    fail(AttemptFailure::OthersMoved,
         fmt::format("another box would move {:.0f} mm", 1e3 * outcome.forces.displacement));
  }
  if (tipped > cell_.limits.tilt) {
    fail(AttemptFailure::OthersMoved,
         fmt::format("another box would lean {:.0f} degrees more", tipped * 180.0 / std::numbers::pi));
  }
  return outcome;
}

const Grasp& Rehearsal::grasp_for(const packing::Placement& placement, double packed_top) {
  for (const Grasp& known : grasps_) {
    if (known.orientation == placement.orientation) return known;
  }
  const motion::Waypoint from =
      motion::make_waypoint(motion::MotionClass::Home, {}, belief_.robot.X_WE, belief_.robot.io);
  grasps_.push_back(plan_grasp({belief_.nominal(), cell_.layout, rollouts_, states_, weights_, from, box_, task_.X_WP,
                                task_.location, packed_top, threads_, cell_.reaches, refused_reorientations()},
                               placement.orientation));
  return grasps_.back();
}

/// All samples, or the first alone where most of these fail: the rate of such an attempt is below what is ever sent.
void Rehearsal::rehearse_samples(const std::function<Outcome(std::size_t)>& execute, Attempt& attempt) const {
  const settings::RehearsalSettings& settings = belief_.nominal().rehearsal;
  const int all = static_cast<int>(rollouts_.size()) - 1;
  std::vector<Outcome> outcomes(static_cast<std::size_t>(all));
  const auto rehearse = [&](int first, int last) {
    parallel_for(last - first, threads_, [&](int i, int) {
      const auto sample = static_cast<std::size_t>(first + i);
      outcomes[sample] = execute(sample + 1);
    });
    attempt.samples = last;
  };
  double good = 0.0, weight = 0.0;
  const auto count = [&] {
    good = weight = 0.0;
    for (int i = 0; i < attempt.samples; ++i) {
      const double own = weights_[static_cast<std::size_t>(i) + 1];
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

/// To RehearsalTask::X_WE_after; none where the robot cannot follow them.
std::vector<motion::Waypoint> Rehearsal::waypoints_to_next(const motion::Waypoint& last) const {
  if (!task_.X_WE_after) return {};
  const motion::Waypoint away =
      motion::make_waypoint(motion::MotionClass::PostPlace, box_.id, *task_.X_WE_after, {}, "_away");
  auto waypoints = drivable(cell_.layout, last, {away});
  if (!can_follow(cell_.reaches, cell_.layout, last, waypoints)) waypoints.clear();
  return waypoints;
}

Rehearsal::Outcome Rehearsal::execute(std::size_t world, const Grasp& grasp,
                                      const std::vector<motion::Waypoint>& waypoints, Attempt& attempt) const {
  Rollout& rollout = *rollouts_[world];
  rollout.restore(grasp.states[world]);
  Episode episode = grasp.episodes[world];
  motion::Program program = grasp.programs[world];
  append(program, waypoints);
  merge(episode, rollout.run(program, {cell_.limits.force, false}));
  if (episode.is_complete()) merge(episode, rollout.settle(program, belief_.nominal().rehearsal.rest));
  Outcome outcome = judge(rollout, before_[world], attempt.planned.X_TP);
  outcome.end = episode.end;
  outcome.forces.force = episode.peak_force;
  outcome.forces.torque = episode.peak_torque;
  if (!episode.is_complete() || !episode.arm_contact.empty()) {  // also while boxes came to rest
    outcome.failure = AttemptFailure::Rollout;
    outcome.text = episode.is_complete() ? episode.arm_contact : episode.text;
  }
  const double hold_factor = rollout.state().gripper.least_hold_factor;
  if (outcome.failure == AttemptFailure::None && hold_factor < cell_.limits.hold_factor) {
    outcome.failure = AttemptFailure::HoldMargin;
    outcome.text = fmt::format("the cup would hold only {:.1f} times its load", hold_factor);
  }
  attempt.ends[world] = rollout.poses();
  return outcome;
}

/// The same place and insertion, whichever way the box was brought up.
bool Rehearsal::was_sent_in_vain(const Attempt& attempt) const {
  return std::ranges::any_of(belief_.failed, [&](const FailedMotion& one) {
    return one.item == box_.item && !one.while_turning && one.skill == attempt.skill &&
           one.planned.orientation.up == attempt.planned.orientation.up &&
           (one.planned.X_TP.p - attempt.planned.X_TP.p).norm() < kSamePlace;
  });
}

/// Ways of turning boxes of this type that met more force than was foreseen.
std::vector<skills::Reorientation> Rehearsal::refused_reorientations() const {
  std::vector<skills::Reorientation> refused;
  const std::string& type = belief_.items[box_.item.slot()].type;
  for (const FailedMotion& one : belief_.failed) {
    const packing::Item& failed = belief_.items[one.item.slot()];
    const bool is_alike = one.item == box_.item || (!type.empty() && failed.type == type);
    if (one.while_turning && is_alike) refused.push_back(one.reorientation);
  }
  return refused;
}

Attempt Rehearsal::attempt(const packing::Candidate& candidate, const skills::Insertion& insertion, double packed_top) {
  Attempt attempt;
  attempt.planned = candidate.placement;
  attempt.skill = insertion.skill;
  if (was_sent_in_vain(attempt)) {
    attempt.was_rehearsed = false;
    attempt.failure = AttemptFailure::SentBefore;
    attempt.text = "sent before, and ended by contact or load";
    return attempt;
  }
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
  attempt.stages = grasp.stages;
  attempt.stage_poses = grasp.stage_poses;
  attempt.X_PS = grasp.X_PS;
  attempt.swing = grasp.swing;
  const motion::Waypoint& last = attempt.program.waypoints.back();
  const skills::PlaceRequest request{box_,      grasp.X_PS, attempt.planned.X_TP, insertion, packed_top,
                                     last.X_WE, grasp.X_EP};
  std::vector<motion::Waypoint> rows = plan_place(belief_.nominal(), cell_.layout, request);
  if (is_always_upright(belief_.nominal())) make_upright(rows, belief_.nominal().cup.hold_length);
  auto waypoints = drivable(cell_.layout, last, rows, grasp.swing);
  if (!can_follow(cell_.reaches, cell_.layout, last, waypoints)) {
    attempt.failure = AttemptFailure::OutOfReach;
    attempt.text = "the robot cannot follow the path to its place";
    return attempt;
  }
  if (const auto away = waypoints_to_next(waypoints.back()); !away.empty()) {
    attempt.leaves = attempt.program.waypoints.size() + waypoints.size() - 1;
    waypoints.insert(waypoints.end(), away.begin(), away.end());
  }
  append(attempt.program, waypoints);
  attempt.ends.resize(rollouts_.size());
  const auto in_world = [&](std::size_t world) { return execute(world, grasp, waypoints, attempt); };
  const Outcome nominal = in_world(0);
  attempt.failure = nominal.failure;
  attempt.text = nominal.text;
  attempt.succeeded = nominal.failure == AttemptFailure::None;
  attempt.was_stopped = nominal.end == RolloutEnd::ProtectiveStop;
  attempt.nominal = nominal.forces;
  if (const auto& arm = rollouts_[0]->state().arm) {
    attempt.q_end.assign(arm->machine.joints.q.begin(), arm->machine.joints.q.end());
  }
  if (attempt.succeeded) rehearse_samples(in_world, attempt);
  return attempt;
}

}  // namespace snug::planning
