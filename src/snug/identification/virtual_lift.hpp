// Virtual lift: what a force sensor and joint encoders would record while the robot lifts a held box.
#pragma once

#include <vector>

#include "snug/core/rng.hpp"
#include "snug/identification/payload.hpp"

namespace snug::identification {

struct Lift {
  SpatialInertia load_S;
  CupFrames frames;
  Matrix6 K = Matrix6::Identity();
  Matrix6 D = Matrix6::Zero();
  double rate = 500.0;    ///< Hz, of the record; a divisor of 1000
  double duration = 1.5;  ///< s
};

/// Simulated (physics::step at 1 ms): up by 250 mm in 0.8 s, from 0.4 s on sideways by 300 mm and tilted by 0.25 rad.
/// Without noise; the lip's pose is not given. InputError when the cup cannot hold the load.
[[nodiscard]] std::vector<PayloadSample> make_lift(const Lift& lift);

/// Adds normal noise to each wrench and one constant bias, drawn once with the deviations given, to all.
void add_noise(std::vector<PayloadSample>& samples, const MeasurementNoise& noise, double force_bias,
               double torque_bias, Rng& rng);

}  // namespace snug::identification
