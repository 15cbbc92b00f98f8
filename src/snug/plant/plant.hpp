// Plant: the cell that is packed, as an interface: motions go in, sensor readings come out, nothing can be undone.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "snug/motion/waypoint.hpp"
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
  std::string item;  ///< that it is for, for records; may be empty
  std::vector<motion::Waypoint> waypoints;
  Guards guards;
  bool operator==(const Motion&) const = default;
};

/// What is done while the tool moves on.
struct OnPassing {
  int waypoint = -1;          ///< of the motion, before its last
  std::function<void()> act;  ///< called once, when the tool has left the waypoint for the next; may be empty
};

enum class EndReason {
  Completed,       ///< the last waypoint was reached
  ForceGuard,      ///< Guards::force; `value` and `limit` in N
  HoldGuard,       ///< Guards::hold_factor; `value` and `limit` are factors
  NoSeal,          ///< the vacuum did not build up; `value` and `limit` in Pa, gauge
  VacuumLost,      ///< it was there and broke down; the same units
  ProtectiveStop,  ///< the robot stopped itself: acknowledge() before it moves again; `where`: joint or sensor
  Timeout,         ///< a waypoint was not reached in time; `value` and `limit` in s
  Refused,  ///< the motion was not begun: an empty one, a pose that is not finite, or after an unacknowledged stop
  Fault,    ///< the plant itself failed; no motion can follow
};
[[nodiscard]] const char* name_of(EndReason reason);

/// How a motion ended.
struct End {
  EndReason reason = EndReason::Completed;
  int waypoint = -1;   ///< of the motion: reached last (Completed), or aimed at
  double value = 0.0;  ///< what was too large (or late); unit as the reason says
  double limit = 0.0;
  std::string where;
  bool operator==(const End&) const = default;
};
/// One line: "force guard: 61 N of 60 N toward Place(BOX027)".
[[nodiscard]] std::string describe(const End& end, std::span<const motion::Waypoint> waypoints);

/// How long a waypoint took. While two are blended the later one counts.
struct WaypointTime {
  double moving = 0.0;   ///< s
  double waiting = 0.0;  ///< s, for the vacuum before the tool moved, and of the last one until tool and boxes stood
  bool operator==(const WaypointTime&) const = default;
};

/// What the robot's own sensors read.
struct Feedback {
  double time = 0.0;  ///< s
  End end;            ///< of the last motion
  Pose X_WE;
  Twist V_WE;
  std::vector<double> q, qd, torques;  ///< rad, rad/s, Nm; empty where the tool moves without joints
  double pressure_gauge = 0.0;         ///< Pa, in the cup; vacuum is negative
  Wrench F_E;                          ///< on the tool, from what it carries or touches, about Eo, in E
  double peak_force = 0.0;             ///< N, of that load during the last motion
  double peak_torque = 0.0;            ///< Nm
  motion::IO io;                       ///< commanded
  std::vector<WaypointTime> times;     ///< of the last motion, waypoint by waypoint; their sum is what it took
  bool operator==(const Feedback&) const = default;
};

/// What is fixed.
struct Description {
  std::string name;                 ///< for people: "simulated, plant seed 7"
  std::vector<std::string> joints;  ///< empty: the tool moves without joints
  bool operator==(const Description&) const = default;
};

/// A cell with one robot. All calls return when what they ask for has ended; between calls the robot stands and the
/// cell goes on or waits, as it likes. No call throws for anything that happens in the cell: that is in
/// `Feedback::end`. Contract: test/suite/plant_contract.hpp.
class Plant {
 public:
  virtual ~Plant() = default;
  [[nodiscard]] virtual Description describe() const = 0;
  /// Sensors now.
  [[nodiscard]] virtual Feedback read() = 0;
  /// Lets the item come to where boxes are picked; what stood there is taken away. False: there is no such item, or it
  /// came before.
  [[nodiscard]] virtual bool bring(const std::string& item) = 0;
  /// Follows the waypoints until the last is reached and the tool stands, or until something ends the motion before.
  /// What `passing` does may perceive and bring, and nothing else; it is not done where the motion ends before.
  [[nodiscard]] virtual Feedback submit(const Motion& motion, const OnPassing& passing) = 0;
  [[nodiscard]] Feedback submit(const Motion& motion) { return submit(motion, {}); }
  /// One look. The only way to learn where boxes are.
  [[nodiscard]] virtual perception::Observation perceive(std::span<const perception::Expectation> expected) = 0;
  /// Releases a protective stop. Without one nothing happens.
  virtual void acknowledge() = 0;
};

}  // namespace snug::plant
