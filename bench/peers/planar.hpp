// Planar: a flat rectangle that slides and turns on a plane with an even pressure, by the planar integral of friction.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::peers {

using Vector2 = Eigen::Vector2d;

struct PlanarMotion {
  Vector2 position = Vector2::Zero();  ///< m
  double yaw = 0.0;                    ///< rad
  Vector2 velocity = Vector2::Zero();  ///< m/s
  double rate = 0.0;                   ///< rad/s
};

/// Where a thin uniform rectangle of half sides `half`, m, comes to rest. 40 x 40 points, steps of 0.1 ms.
[[nodiscard]] PlanarMotion planar_rest(const PlanarMotion& start, const Vector2& half, double friction);

}  // namespace snug::peers
