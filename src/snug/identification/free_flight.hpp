// Free flight: how a body moved before it touched anything, from poses of it.
#pragma once

#include <span>

#include "snug/record/recording.hpp"

namespace snug::identification {

struct FlightStart {
  Pose X_WB;
  Twist V_WB;  ///< linear part at the origin of B, in W
  /// What the poses are off the flight by: root mean square of one coordinate, for the unknowns that were fitted.
  double position_rms = 0.0;  ///< m
  double rotation_rms = 0.0;  ///< rad
};

/// Start of the free flight (gravity alone, rotation by Euler's equations) that fits the poses best: least squares, the
/// rotation first, then the parabola of the centre of mass. At least three poses at growing times [s]; the start is at
/// the first.
[[nodiscard]] FlightStart fit_free_flight(std::span<const double> times, std::span<const record::PoseSample> poses,
                                          const SpatialInertia& inertia, const Vector3& gravity);

}  // namespace snug::identification
