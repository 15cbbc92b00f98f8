// Waypoint, Program: where the tool goes and what it switches.
#include "snug/motion/waypoint.hpp"

#include <fmt/format.h>

namespace snug::motion {

Waypoint make_waypoint(MotionClass motion_class, std::string_view item, const Pose& X_WE, const IO& io,
                       std::string_view variant) {
  Waypoint waypoint;
  waypoint.X_WE = X_WE;
  waypoint.motion_class = motion_class;
  waypoint.item = item;
  waypoint.variant = variant;
  waypoint.io = io;
  return waypoint;
}

std::string place_of(const Program& program, std::size_t row) {
  const int line = program.waypoints[row].line;
  return line > 0 ? fmt::format("{}:{}", program.name, line) : fmt::format("{} row {}", program.name, row + 1);
}

}  // namespace snug::motion
