// What rows of a program are written with: the states of the switches, poses at a height.
#pragma once

#include "snug/motion/waypoint.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::skills::internal {

inline constexpr motion::IO kHold{.vacuum = true};
inline constexpr motion::IO kRelease{.blow_off = true};

/// The pose with its origin at height z [m].
[[nodiscard]] inline Pose at_height(Pose X, double z) {
  X.p.z() = z;
  return X;
}

}  // namespace snug::skills::internal
