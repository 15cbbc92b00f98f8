// What rows of a program are written with: the states of the switches, poses at a height, which side of a box is up.
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

/// Index of the P axis that is nearest to the vertical.
[[nodiscard]] inline int vertical_axis_of(const Matrix3& R_WP) {
  int axis = 0;
  R_WP.row(2).cwiseAbs().maxCoeff(&axis);
  return axis;
}

}  // namespace snug::skills::internal
