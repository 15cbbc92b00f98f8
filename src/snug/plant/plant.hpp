// Plant: the cell that is packed, as an interface that steps: motions go in, events and sensor readings come out.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/model/ids.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/motion/waypoint_index.hpp"
#include "snug/perception/observation.hpp"

namespace snug::plant {

/// What ends a motion before its last waypoint.
struct Guards {
  /// N, of the load on the tool, weight of the held box included: the tool stops where it is. Absent: not guarded.
  std::optional<double> force;
  /// Ends the motion when a vacuum that is on is not built up, or breaks down.
  bool vacuum = true;
  /// How many times what it has to the cup must be able to hold (TickReading::hold_factor): below, the tool stops where
  /// it is. 0: not guarded.
  double hold_factor = 0.0;
  bool operator==(const Guards&) const = default;
};

/// Waypoints that are followed one after the other, from where the tool is.
struct Motion {
  model::ParcelId item;  ///< that it is for, for records; may be none
  std::vector<motion::Waypoint> waypoints;
  Guards guards = {};
  /// The boxes will be perceived when the tool has passed this waypoint, while it moves on; absent: when it stands.
  /// Then the motion lasts until boxes that were let go are at rest. The last waypoint is not passed.
  std::optional<motion::WaypointIndex> perceive_after = {};
  bool operator==(const Motion&) const = default;
};

enum class EndReason {
  Completed,       ///< the last waypoint was reached
  ForceGuard,      ///< Guards::force; `value` and `limit` in N
  HoldGuard,       ///< Guards::hold_factor; `value` and `limit` are factors
  NoSeal,          ///< the vacuum did not build up; `value` and `limit` in Pa, gauge
  VacuumLost,      ///< it was there and broke down; the same units
  ProtectiveStop,  ///< the robot stopped itself: acknowledge() before it moves again; `where`: joint or sensor
  Timeout,         ///< a waypoint was not reached in time; `value` and `limit` in s
  Cancelled,       ///< Plant::cancel
  Refused,  ///< the motion was not begun: an empty one, a pose that is not finite, or after an unacknowledged stop
  Fault,    ///< the plant itself failed; no motion can follow
};
[[nodiscard]] const char* name_of(EndReason reason);

/// How a motion ended.
struct End {
  EndReason reason = EndReason::Completed;
  /// Reached last (Completed), or aimed at. Absent: none, the motion was not begun.
  std::optional<motion::WaypointIndex> waypoint;
  double value = 0.0;  ///< what was too large (or late); unit as the reason says
  double limit = 0.0;
  std::string where;
  bool operator==(const End&) const = default;
};
/// One line: "force guard: 61 N of 60 N toward Place(BOX027)". `waypoints`: of the motion; may be empty.
[[nodiscard]] std::string describe(const End& end, std::span<const motion::Waypoint> waypoints);

/// How long a waypoint took. While two are blended the later one counts.
struct WaypointTime {
  double moving = 0.0;   ///< s
  double waiting = 0.0;  ///< s, for the vacuum before the tool moved, and of the last one until tool and boxes stood
  bool operator==(const WaypointTime&) const = default;
};

/// What the robot's own sensors read, and what the motion came to that is under way or was the last one.
struct Feedback {
  double time = 0.0;  ///< s
  End end;            ///< of the last motion that ended
  Pose X_WE;
  Twist V_WE;
  std::vector<double> q, qd, torques;  ///< rad, rad/s, Nm; empty where the tool moves without joints
  double pressure_gauge = 0.0;         ///< Pa, in the cup; vacuum is negative
  Wrench F_E;                          ///< on the tool, from what it carries or touches, about Eo, in E
  double peak_force = 0.0;             ///< N, of that load during the motion
  double peak_torque = 0.0;            ///< Nm
  motion::IO io;                       ///< commanded
  std::vector<WaypointTime> times;     ///< of the motion, waypoint by waypoint; their sum is what it took
  bool operator==(const Feedback&) const = default;
};

/// What is fixed.
struct Description {
  std::string name;                 ///< for people: "simulated, plant seed 7"
  std::vector<std::string> joints;  ///< empty: the tool moves without joints
  double longest_advance = 0.0;  ///< s of wall clock that advance() waits at most; 0: it only computes, or is answered
  bool operator==(const Description&) const = default;
};

struct Event;

/// A cell with one robot. It goes on in `advance` alone, at most a tick of its controller each time; every other call
/// asks for something, or reads, and returns at once. Nothing is called back.
///
/// No call throws for anything that happens in the cell: that is an event. Every motion that is started has exactly one
/// MotionEnded, every item that is brought exactly one ItemArrived (or a Fault), every perceive exactly one Perceived.
/// Events come in the order of their times. Contract: test/suite/plant_contract.hpp.
class Plant {
 public:
  virtual ~Plant() = default;
  [[nodiscard]] virtual Description describe() const = 0;
  /// Sensors now.
  [[nodiscard]] virtual Feedback read() = 0;
  /// A motion was started and its MotionEnded has not come out of advance().
  [[nodiscard]] virtual bool is_moving() const = 0;

  /// Begins to follow the waypoints: until the last is reached and the tool stands, or until something ends the motion
  /// before. A motion that cannot be is refused: its MotionEnded says so. Not while one is under way (checked).
  virtual void start(const Motion& motion) = 0;
  /// What happened since the last call. Returns at once with what is known already; else the cell makes a tick (or is
  /// waited for) and what that brought is returned, which may be nothing. Without a motion no time passes.
  [[nodiscard]] virtual std::vector<Event> advance() = 0;
  /// The tool stops where it is, and the motion ends: Cancelled. Without a motion nothing happens.
  virtual void cancel() = 0;

  /// Lets the item come to where boxes are picked; what stood there is taken away. ItemArrived when it is there: during
  /// a motion at the end of a tick, else at the next advance(). False, and no event: there is no such item, or it was
  /// brought before, or the plant has failed. During a motion, too.
  [[nodiscard]] virtual bool bring(const model::ParcelId& item) = 0;
  /// Perceives once: the only way to learn where boxes are; the answer is a Perceived. During a motion, too.
  virtual void perceive(std::span<const perception::Expectation> expected) = 0;
  /// Releases a protective stop. Without one nothing happens.
  virtual void acknowledge() = 0;
};

}  // namespace snug::plant
