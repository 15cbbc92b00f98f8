// Virtual experiments: what sensors would record of a cup whose numbers are known.
#pragma once

#include <vector>

#include "snug/core/rng.hpp"
#include "snug/identification/releases.hpp"

namespace snug::identification {

/// `count` random loads (0.25 to 2.2 kg, centre of mass up to 40 mm off the axis and 30 to 60 mm from the lip) at rest
/// under a gripper tilted by up to 75 degrees, without noise; gravity's wrench is there as the sensor's. Loads that
/// would bend the cup by more than 35 degrees are drawn again. K in S1.
[[nodiscard]] StaticPoses make_static_poses(const Matrix6& K, const CupFrames& frames, int count, Rng& rng);

enum class PluckDirection { Axial, Lateral, Bend, Torsion };

/// A load hanging straight down, pulled from rest and let go.
struct Pluck {
  SpatialInertia load_S;
  CupFrames frames;
  Matrix6 K = Matrix6::Identity();
  Matrix6 D = Matrix6::Zero();
  PluckDirection direction = PluckDirection::Axial;
  double amplitude = 0.004;  ///< m, or rad for Bend and Torsion
  double rate = 360.0;       ///< Hz, of the record
  double duration = 1.5;     ///< s
};
/// Without noise. InputError when the cup cannot hold the load.
[[nodiscard]] Release make_pluck(const Pluck& pluck);

/// Adds normal noise of `noise` to poses and wrenches.
void add_noise(StaticPoses& poses, const MeasurementNoise& noise, Rng& rng);
void add_noise(Release& release, const MeasurementNoise& noise, Rng& rng);

}  // namespace snug::identification
