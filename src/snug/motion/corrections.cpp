// Corrections: shifts of named waypoints that make up for what a program's author could not foresee at a site.
#include "snug/motion/corrections.hpp"

#include <algorithm>

#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {

Program apply_corrections(Program program, std::span<const Correction> corrections) {
  for (Waypoint& waypoint : program.waypoints) {
    const std::string name = name_of(waypoint);
    for (const Correction& correction : corrections) {
      const bool matches =
          std::ranges::any_of(correction.prefixes, [&](const std::string& prefix) { return name.starts_with(prefix); });
      if (matches) waypoint.X_WE.p += correction.offset;
    }
  }
  return program;
}

}  // namespace snug::motion
