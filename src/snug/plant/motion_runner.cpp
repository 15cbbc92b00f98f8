// MotionRunner: one motion from its start to its end, for every plant whose robot moves tick by tick.
#include "snug/plant/motion_runner.hpp"

#include <algorithm>
#include <utility>

#include "snug/core/check.hpp"

namespace snug::plant {

RunnerSettings runner_settings(const model::Scenario& scenario, bool is_lagged) {
  const double needed = scenario.motion_guards.needed_vacuum * scenario.cup.vacuum.pressure_gauge_hold;
  return {scenario.motion_guards, needed, is_lagged};
}

const char* MotionRunner::find_refusal(const Motion& motion) {
  if (motion.waypoints.empty()) return "no waypoints";
  const bool is_finite = std::ranges::all_of(motion.waypoints, [](const motion::Waypoint& waypoint) {
    return waypoint.X_WE.p.allFinite() && waypoint.X_WE.R.allFinite();
  });
  return is_finite ? "" : "a pose that is not finite";
}

void MotionRunner::refuse(std::string why, Feedback& feedback) {
  feedback.end = {EndReason::Refused, std::nullopt, 0.0, 0.0, std::move(why)};
  feedback.peak_force = feedback.F_E.force.norm();
  feedback.peak_torque = feedback.F_E.torque.norm();
  feedback.times.clear();
  add({feedback.time, MotionEnded{feedback}});
}

void MotionRunner::begin(const Motion& motion, const TickReading& start, bool is_held) {
  SNUG_CHECK(!is_moving(), "a motion is under way");
  MotionRunner fresh(settings_);
  fresh.events_ = std::move(events_);
  *this = std::move(fresh);
  motion_ = motion;
  phase_ = MotionPhase::Following;
  waypoint_since_ = last_ = start.time;
  if (!start.is_vacuum_on) return;
  vacuum_since_ = start.time;
  is_sealed_ = is_held;
}

void MotionRunner::follow(const TickAim& aim) {
  if (aim.waypoint != aimed_at_) waypoint_since_ = aim.time;
  aimed_at_ = aim.waypoint;
  if (times_.size() <= aim.waypoint.slot()) times_.resize(aim.waypoint.slot() + 1);
  WaypointTime& time = times_[aim.waypoint.slot()];
  (aim.is_waiting ? time.waiting : time.moving) += aim.time - last_;
  last_ = aim.time;
}

void MotionRunner::rest(double time) {
  if (!times_.empty()) times_.back().waiting += time - last_;
  last_ = time;
}

void MotionRunner::trip(EndReason reason, double value, double limit, double time) {
  if (has_ended()) return;
  end_ = {reason, aimed_at_, value, limit, ""};
  if (reason == EndReason::ForceGuard || reason == EndReason::HoldGuard) add({time, GuardTripped{end_}});
}

void MotionRunner::check(const TickReading& now) {
  const double force = now.F_E.force.norm();
  peak_force_ = std::max(peak_force_, force);
  peak_torque_ = std::max(peak_torque_, now.F_E.torque.norm());
  const Guards& guards = motion_.guards;
  if (guards.force && force > *guards.force) trip(EndReason::ForceGuard, force, *guards.force, now.time);
  if (now.is_vacuum_on && now.hold_factor < guards.hold_factor) {
    trip(EndReason::HoldGuard, now.hold_factor, guards.hold_factor, now.time);
  }
  check_vacuum(now);
  const double patience = settings_.guards.waypoint_patience, taken = now.time - waypoint_since_;
  if (taken > patience) trip(EndReason::Timeout, taken, patience, now.time);
  if (!has_ended()) note_passed(now.time);
}

void MotionRunner::check_vacuum(const TickReading& now) {
  if (!now.is_vacuum_on) {
    vacuum_since_ = -1.0;
    is_sealed_ = has_dropped_ = false;
    return;
  }
  if (vacuum_since_ < 0.0) vacuum_since_ = now.time;
  const bool is_deep = now.pressure_gauge <= settings_.pressure_needed;
  if (is_deep) {
    if (!is_sealed_ || has_dropped_) add({now.time, VacuumBuilt{now.pressure_gauge}});
    is_sealed_ = true;
    has_dropped_ = false;
    return;
  }
  if (is_sealed_ && !has_dropped_) {
    has_dropped_ = true;
    add({now.time, VacuumDropped{now.pressure_gauge}});
  }
  if (!motion_.guards.vacuum) return;
  if (is_sealed_) {
    trip(EndReason::VacuumLost, now.pressure_gauge, settings_.pressure_needed, now.time);
  } else if (now.time - vacuum_since_ > settings_.guards.seal_patience) {
    trip(EndReason::NoSeal, now.pressure_gauge, settings_.pressure_needed, now.time);
  }
}

void MotionRunner::note_passed(double time) {
  while (aimed_at_ && passed_count_ < aimed_at_->value)
    add({time, WaypointPassed{motion::WaypointIndex(passed_count_++)}});
}

bool MotionRunner::has_passed_perception() const {
  return motion_.perceive_after && aimed_at_ && *aimed_at_ > *motion_.perceive_after;
}

void MotionRunner::stop(EndReason reason, double value, double limit, std::string where) {
  end_ = {reason, aimed_at_, value, limit, std::move(where)};
}

void MotionRunner::arrive(double time) {
  SNUG_CHECK(phase_ == MotionPhase::Following && !has_ended(), "a motion arrives once");
  phase_ = MotionPhase::Settling;
  arrived_ = time;
  end_.waypoint = motion::WaypointIndex(motion_.waypoints.size() - 1);
}

bool MotionRunner::is_settled(double time, double speed) const {
  const settings::MotionGuards& guards = settings_.guards;
  const double at_least = settings_.is_lagged       ? guards.lagged_settle
                          : has_passed_perception() ? 0.0  // boxes were perceived already
                                                    : guards.exact_settle;
  return time >= arrived_ + guards.longest_settle || (time > arrived_ + at_least && !(speed >= guards.still_speed));
}

void MotionRunner::fill(Feedback& feedback) const {
  feedback.peak_force = std::max(peak_force_, feedback.F_E.force.norm());
  feedback.peak_torque = std::max(peak_torque_, feedback.F_E.torque.norm());
  feedback.times = times_;
}

void MotionRunner::finish(Feedback& feedback) {
  SNUG_CHECK(is_moving(), "a motion ends once");
  phase_ = MotionPhase::Standing;
  fill(feedback);
  feedback.end = end_;
  add({feedback.time, MotionEnded{feedback}});
}

}  // namespace snug::plant
