// MotionWatch: what ends a motion before its last waypoint, for every plant whose robot moves tick by tick.
#pragma once

#include <limits>

#include "snug/plant/plant.hpp"
#include "snug/settings/session_settings.hpp"

namespace snug::plant {

/// What the robot's sensors read at the end of a tick.
struct TickReading {
  double time = 0.0;                                             ///< s
  Wrench F_E;                                                    ///< Feedback::F_E
  double pressure_gauge = 0.0;                                   ///< Pa, in the cup
  bool is_vacuum_on = false;                                     ///< commanded
  double hold_factor = std::numeric_limits<double>::infinity();  ///< cup::sensed_hold_factor
};

/// One motion under way: how it ends, and its peaks.
struct MotionWatch {
  settings::MotionGuards settings;
  End end;
  int row = -1;  ///< of the motion, aimed at
  double peak_force = 0.0, peak_torque = 0.0;
  std::vector<WaypointTime> times;  ///< up to the waypoint aimed at

  /// `start`: before the first tick. `is_held`: something hangs from the cup.
  void begin(const TickReading& start, bool is_held);
  /// After each tick; `aimed_at`: row of the motion; `is_waiting`: for the vacuum, before the tool moves to it.
  void follow(int aimed_at, double time, bool is_waiting = false);
  /// When tool and boxes have come to rest after the last waypoint.
  void rest(double time);
  /// Guards and patience. `pressure_needed`: Pa, of a seal. The first reason stays.
  void check(const Guards& guards, double pressure_needed, const TickReading& now);

 private:
  double row_since_ = 0.0;
  double last_ = 0.0;           ///< s, of the last call
  double vacuum_since_ = -1.0;  ///< s, or -1: it is off
  bool was_sealed_ = false;     ///< since then
};

/// s, at least, that a motion goes on after its end so that boxes come to rest. `is_lagged`: the tool comes in with a
/// lag. `was_passed`: OnPassing was called; they were looked at then.
[[nodiscard]] double least_settle(const settings::MotionGuards& settings, bool is_lagged, bool was_passed);
/// Whether a motion that came to its end at `start` s goes on at `now`, for `at_least` s and so that the tool, at
/// `speed` m/s, comes to stand.
[[nodiscard]] bool is_settling(const settings::MotionGuards& settings, double at_least, double start, double now,
                               double speed);

/// Why the motion cannot begin: no waypoints, a pose that is not finite; empty when it can.
[[nodiscard]] const char* find_refusal(const Motion& motion);

}  // namespace snug::plant
