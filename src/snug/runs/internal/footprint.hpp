// Footprint: a rectangle on the floor, turned.
#pragma once

#include <array>

#include "snug/spatial/pose.hpp"

namespace snug::runs::internal {

struct Footprint {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d half = Eigen::Vector2d::Zero();    ///< m
  double yaw = 0.0;                                  ///< rad

  [[nodiscard]] std::array<Eigen::Vector2d, 4> corners() const;
  /// Whether less than `gap` [m] is between them, measured across their edges.
  [[nodiscard]] bool is_near(const Footprint& other, double gap) const;
  /// Whether the other is within this one.
  [[nodiscard]] bool holds(const Footprint& other) const;
};

}  // namespace snug::runs::internal
