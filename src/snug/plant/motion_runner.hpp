// MotionRunner: one motion from its start to its end, for every plant whose robot moves tick by tick: what was passed,
// what ends it, how long it took, and the events of it.
#pragma once

#include <limits>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/plant/event.hpp"

namespace snug::plant {

/// What the robot's sensors read at the end of a tick.
struct TickReading {
  double time = 0.0;                                             ///< s
  Wrench F_E;                                                    ///< Feedback::F_E
  double pressure_gauge = 0.0;                                   ///< Pa, in the cup
  bool is_vacuum_on = false;                                     ///< commanded
  double hold_factor = std::numeric_limits<double>::infinity();  ///< cup::sensed_hold_factor
};

/// Where a tick led.
struct TickAim {
  motion::WaypointIndex waypoint;
  double time = 0.0;        ///< s, at its end
  bool is_waiting = false;  ///< for the vacuum, before the tool moves to the waypoint
};

struct RunnerSettings {
  settings::MotionGuards guards;
  double pressure_needed = 0.0;  ///< Pa, gauge, of a seal
  bool is_lagged = false;        ///< the tool comes in with a lag
};

/// `is_lagged`: the scenario's robot is moved with its lag.
[[nodiscard]] RunnerSettings runner_settings(const model::Scenario& scenario, bool is_lagged);

enum class MotionPhase {
  Standing,
  Following,  ///< the waypoints
  Settling,   ///< the last is reached; tool and boxes come to rest
};

/// The plant does the ticks and says what each came to:
///
///     begin(motion, reading, is_held);
///     while following:  follow(aim); check(reading); [stop(end)]     until has_ended(), or the last waypoint: arrive()
///     while settling:   until is_settled()                           then rest()
///     finish(feedback)
///
/// and hands on the events that take_events() gives. Where anything ends the motion before, finish() comes at once.
class MotionRunner {
 public:
  explicit MotionRunner(const RunnerSettings& settings) : settings_(settings) {}

  [[nodiscard]] MotionPhase phase() const { return phase_; }
  [[nodiscard]] bool is_moving() const { return phase_ != MotionPhase::Standing; }
  /// Why the motion cannot begin: no waypoints, a pose that is not finite; empty when it can.
  [[nodiscard]] static const char* find_refusal(const Motion& motion);
  /// It ends before it begins: `feedback` as the sensors read.
  void refuse(std::string why, Feedback& feedback);

  /// `start`: before the first tick. `is_held`: something hangs from the cup.
  void begin(const Motion& motion, const TickReading& start, bool is_held);
  /// After each tick toward a waypoint, before check().
  void follow(const TickAim& aim);
  /// Guards, patience, and what was passed, by the reading at the end of that tick. The first reason to end stays.
  void check(const TickReading& now);
  /// Ends the motion for another reason than a guard; this one stays.
  void stop(EndReason reason, double value = 0.0, double limit = 0.0, std::string where = {});
  /// The last waypoint is reached.
  void arrive(double time);
  /// `speed`: m/s, of the tool. Whether the motion that has arrived is over.
  [[nodiscard]] bool is_settled(double time, double speed) const;
  /// The time until now was rest, after the waypoint aimed at.
  void rest(double time);
  /// Puts what the motion came to into `feedback`, which has the sensors when the tool stood, and ends it.
  void finish(Feedback& feedback);
  /// The same of a motion under way, which goes on.
  void fill(Feedback& feedback) const;

  [[nodiscard]] const Motion& motion() const { return motion_; }
  [[nodiscard]] bool has_ended() const { return end_.reason != EndReason::Completed; }
  [[nodiscard]] const End& end() const { return end_; }
  /// Motion::perceive_after lies behind the tool.
  [[nodiscard]] bool has_passed_perception() const;
  /// The waypoint aimed at, if there is one.
  [[nodiscard]] std::optional<motion::WaypointIndex> aimed_at() const { return aimed_at_; }
  [[nodiscard]] const RunnerSettings& settings() const { return settings_; }

  /// Any event of the plant, behind those that are here.
  void add(Event event) { events_.push_back(std::move(event)); }
  [[nodiscard]] bool has_events() const { return !events_.empty(); }
  [[nodiscard]] std::vector<Event> take_events() { return std::exchange(events_, {}); }

 private:
  void trip(EndReason reason, double value, double limit, double time);
  void check_vacuum(const TickReading& now);
  void note_passed(double time);

  RunnerSettings settings_;
  MotionPhase phase_ = MotionPhase::Standing;
  Motion motion_;
  End end_;
  std::optional<motion::WaypointIndex> aimed_at_;
  int passed_count_ = 0;  ///< waypoints that were said to be passed
  double peak_force_ = 0.0, peak_torque_ = 0.0;
  std::vector<WaypointTime> times_;  ///< up to the waypoint aimed at
  double waypoint_since_ = 0.0;
  double last_ = 0.0;           ///< s, up to which `times_` counts
  double arrived_ = 0.0;        ///< s, at the last waypoint
  double vacuum_since_ = -1.0;  ///< s, or -1: it is off
  bool is_sealed_ = false;      ///< since then
  bool has_dropped_ = false;    ///< since then, and said so
  std::vector<Event> events_;
};

}  // namespace snug::plant
