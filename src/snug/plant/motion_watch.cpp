// MotionWatch: what ends a motion before its last waypoint, for every plant whose robot moves tick by tick.
#include "snug/plant/motion_watch.hpp"

#include <algorithm>

namespace snug::plant {
void MotionWatch::begin(const TickReading& start, bool is_held) {
  row_since_ = last_ = start.time;
  if (!start.is_vacuum_on) return;
  vacuum_since_ = start.time;
  was_sealed_ = is_held;
}

void MotionWatch::follow(int aimed_at, double time, bool is_waiting) {
  if (aimed_at != row) row_since_ = time;
  row = aimed_at;
  const auto index = static_cast<std::size_t>(std::max(0, aimed_at));
  if (times.size() <= index) times.resize(index + 1);
  (is_waiting ? times[index].waiting : times[index].moving) += time - last_;
  last_ = time;
}

void MotionWatch::rest(double time) {
  if (!times.empty()) times.back().waiting += time - last_;
  last_ = time;
}

void MotionWatch::check(const Guards& guards, double pressure_needed, const TickReading& now) {
  const double force = now.F_E.force.norm(), pressure = now.pressure_gauge;
  peak_force = std::max(peak_force, force);
  peak_torque = std::max(peak_torque, now.F_E.torque.norm());
  const auto stop = [&](EndReason reason, double value, double limit) {
    if (end.reason == EndReason::Completed) end = {reason, row, value, limit, ""};
  };
  if (guards.force && force > *guards.force) stop(EndReason::ForceGuard, force, *guards.force);
  if (now.is_vacuum_on && now.hold_factor < guards.hold_factor) {
    stop(EndReason::HoldGuard, now.hold_factor, guards.hold_factor);
  }
  if (!now.is_vacuum_on) {
    vacuum_since_ = -1.0;
    was_sealed_ = false;
  } else if (vacuum_since_ < 0.0) {
    vacuum_since_ = now.time;
  }
  if (now.is_vacuum_on && pressure <= pressure_needed) was_sealed_ = true;
  if (guards.vacuum && now.is_vacuum_on && pressure > pressure_needed &&
      (was_sealed_ || now.time - vacuum_since_ > settings.seal_patience)) {
    stop(was_sealed_ ? EndReason::VacuumLost : EndReason::NoSeal, pressure, pressure_needed);
  }
  if (now.time - row_since_ > settings.waypoint_patience)
    stop(EndReason::Timeout, now.time - row_since_, settings.waypoint_patience);
}

double least_settle(const settings::MotionGuards& settings, bool is_lagged, bool was_passed) {
  return is_lagged ? settings.lagged_settle : was_passed ? 0.0 : settings.exact_settle;
}

bool is_settling(const settings::MotionGuards& settings, double at_least, double start, double now, double speed) {
  return now < start + settings.longest_settle && (now <= start + at_least || speed >= settings.still_speed);
}

const char* find_refusal(const Motion& motion) {
  if (motion.waypoints.empty()) return "no waypoints";
  const bool is_finite = std::ranges::all_of(motion.waypoints, [](const motion::Waypoint& waypoint) {
    return waypoint.X_WE.p.allFinite() && waypoint.X_WE.R.allFinite();
  });
  return is_finite ? "" : "a pose that is not finite";
}

}  // namespace snug::plant
