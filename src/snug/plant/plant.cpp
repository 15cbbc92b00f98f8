// Plant: the cell that is packed, as an interface: words for what it says.
#include "snug/plant/plant.hpp"

#include <fmt/format.h>

#include "snug/motion/waypoint_name.hpp"

namespace snug::plant {

const char* name_of(EndReason reason) {
  switch (reason) {
    case EndReason::Completed:
      return "completed";
    case EndReason::ForceGuard:
      return "force guard";
    case EndReason::HoldGuard:
      return "hold guard";
    case EndReason::NoSeal:
      return "no seal";
    case EndReason::VacuumLost:
      return "vacuum lost";
    case EndReason::ProtectiveStop:
      return "protective stop";
    case EndReason::Timeout:
      return "timeout";
    case EndReason::Cancelled:
      return "cancelled";
    case EndReason::Refused:
      return "refused";
    case EndReason::Fault:
      return "fault";
  }
  return "";
}

std::string describe(const End& end, std::span<const motion::Waypoint> waypoints) {
  std::string text = name_of(end.reason);
  switch (end.reason) {
    case EndReason::ForceGuard:
      text += fmt::format(": {:.0f} N of {:.0f} N", end.value, end.limit);
      break;
    case EndReason::HoldGuard:
      text += fmt::format(": the cup could hold {:.1f} times its load, {:.1f} times are needed", end.value, end.limit);
      break;
    case EndReason::NoSeal:
    case EndReason::VacuumLost:
      text += fmt::format(": {:.0f} Pa, {:.0f} Pa is needed", end.value, end.limit);
      break;
    case EndReason::Timeout:
      text += fmt::format(": after {:.1f} s", end.limit);
      break;
    default:
      break;
  }
  if (!end.where.empty()) text += ": " + end.where;
  if (end.reason != EndReason::Completed && end.waypoint && end.waypoint->slot() < waypoints.size()) {
    text += " toward " + motion::name_of(waypoints[end.waypoint->slot()]);
  }
  return text;
}

}  // namespace snug::plant
