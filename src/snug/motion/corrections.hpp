// Corrections: shifts of named waypoints that make up for what a program's author could not foresee at a site.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/motion/waypoint.hpp"

namespace snug::motion {

/// Shift of the waypoints whose names start with one of the prefixes (case counts).
struct Correction {
  std::vector<std::string> prefixes;
  Vector3 offset = Vector3::Zero();  ///< m, in W
  bool operator==(const Correction&) const = default;
};

/// The program with its rows shifted. A correction shifts a row once, however many of its prefixes match; different
/// corrections that match the same row add.
[[nodiscard]] Program apply_corrections(Program program, std::span<const Correction> corrections);

}  // namespace snug::motion
