// ProtectiveStop: why the arm of a cell stopped itself.
#pragma once

#include <string>

namespace snug::cell {

enum class StopCause {
  JointTorque,
  JointSpeed,  ///< of joints that are driven from outside
  JointRange,  ///< the same
  SensorForce,
  SensorTorque,
  TrackingError,
  Stuck,  ///< a waypoint was not reached in time
};
[[nodiscard]] const char* name_of(StopCause cause);

/// Why the arm stopped.
struct ProtectiveStop {
  StopCause cause = StopCause::JointTorque;
  std::string where;  ///< joint, sensor or waypoint
  double value = 0.0;
  double limit = 0.0;
  std::string unit;
  double time = 0.0;       ///< s
  int row = -1;            ///< of the program, aimed at; -1 without one
  std::string waypoint;    ///< its name
  std::string touching;    ///< what the arm touched, with force, or empty
  std::string limited_by;  ///< limits of the controller that were active, or empty
};
/// One line.
[[nodiscard]] std::string describe(const ProtectiveStop& stop);

}  // namespace snug::cell
