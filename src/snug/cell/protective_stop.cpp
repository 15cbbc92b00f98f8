// ProtectiveStop: why the arm of a cell stopped itself.
#include "snug/cell/protective_stop.hpp"

#include <fmt/format.h>

namespace snug::cell {

const char* name_of(StopCause cause) {
  switch (cause) {
    case StopCause::JointTorque:
      return "joint torque";
    case StopCause::JointSpeed:
      return "joint speed";
    case StopCause::JointRange:
      return "joint range";
    case StopCause::SensorForce:
      return "sensor force";
    case StopCause::SensorTorque:
      return "sensor torque";
    case StopCause::TrackingError:
      return "tracking error";
    case StopCause::Stuck:
      return "stuck";
  }
  return "";
}

std::string describe(const ProtectiveStop& stop) {
  std::string text = fmt::format("protective stop at {:.3f} s", stop.time);
  if (stop.row >= 0) text += fmt::format(" toward {} (row {})", stop.waypoint, stop.row + 1);
  text += ": ";
  text += stop.cause == StopCause::Stuck ? fmt::format("stuck {:.3f} m from it", stop.value)
                                         : fmt::format("{} of {}: {:.4g} {}, limit {:.4g} {}", name_of(stop.cause),
                                                       stop.where, stop.value, stop.unit, stop.limit, stop.unit);
  if (!stop.touching.empty()) text += "; touching " + stop.touching;
  if (!stop.limited_by.empty()) text += "; " + stop.limited_by;
  return text;
}

}  // namespace snug::cell
