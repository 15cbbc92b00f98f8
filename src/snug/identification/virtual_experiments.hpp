// Virtual experiments: what sensors would record of a cup whose numbers are known.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
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
/// Of "axial", "lateral", "bend" or "torsion" (checked).
[[nodiscard]] PluckDirection pluck_direction_of(std::string_view name);
/// Whether it is an angle that is pulled.
[[nodiscard]] bool is_turn(PluckDirection direction);
/// A box of `size` (m; its inertia about its own middle, Z up) held by the middle of its upper face: Sz points into it.
/// `amplitude`: m or rad, by default 0.004 or 0.1. Throws InputError for one that no cup of this kind bears.
[[nodiscard]] Pluck plan_pluck(const model::CupParams& cup, const Vector3& size, const SpatialInertia& box,
                               PluckDirection direction, std::optional<double> amplitude);
/// The same pluck again and again, as sensors with this noise would record it.
[[nodiscard]] std::vector<Release> make_plucks(const Pluck& pluck, int count, const MeasurementNoise& noise,
                                               std::uint64_t seed);
/// Without noise. InputError when the cup cannot hold the load.
[[nodiscard]] Release make_pluck(const Pluck& pluck);

/// Adds normal noise of `noise` to poses and wrenches.
void add_noise(StaticPoses& poses, const MeasurementNoise& noise, Rng& rng);
void add_noise(Release& release, const MeasurementNoise& noise, Rng& rng);

}  // namespace snug::identification
