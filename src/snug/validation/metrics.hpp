// Metrics: how far a prediction is from a measurement, in two named forms.
#pragma once

#include <string>
#include <vector>

#include "snug/validation/measurement.hpp"

namespace snug::validation {

/// A span of the simulation's time in which a body is compared.
struct Window {
  std::string body;               ///< name in the simulation
  double start = 0.0, end = 0.0;  ///< s
  bool operator==(const Window&) const = default;
};

/// `Report`: the demonstrator's rules (its analysis: outliers, filled gaps, smoothing of the measured side, difference
/// of rotation vectors, errors beyond 150 mm and 15 degrees dropped before the mean). `Clean`: the geodesic angle,
/// nothing filled, smoothed or dropped; instants at which the markers were lost are counted.
enum class Form { Clean, Report };

/// Errors of one body in one window and repetition; NaN where nothing was measured. SI.
struct Errors {
  double rest_position = 0.0, rest_rotation = 0.0;  ///< m, rad: at the window's end
  double rms_position = 0.0, rms_rotation = 0.0;    ///< m, rad: over the window
  double rms_force = 0.0, rms_torque = 0.0;         ///< N, Nm
  double tracked = 0.0;  ///< share of the simulation's instants in the window at which the body was measured
  double dropped = 0.0;  ///< share of those that the form dropped as outliers
};

/// A body is compared over a window when it was tracked for this share of it, in both forms; otherwise not at all.
inline constexpr double kLeastTracked = 0.5;
/// The clean rest pose is the mean over this last part of the window, s.
inline constexpr double kRestSpan = 0.5;

[[nodiscard]] Errors compare(const SimulatedRun& run, const Measurement& measurement, const Window& window, Form form);

/// Instant by instant, for plots: clean, in W, SI. NaN where lost.
struct PoseSeries {
  std::vector<double> times;
  std::vector<Vector3> p_simulated, p_measured;        ///< m
  std::vector<Vector3> w_simulated, w_measured;        ///< rotation vectors, rad, continuous in time
  std::vector<double> position_error, rotation_error;  ///< m; rad, geodesic
};
[[nodiscard]] PoseSeries pose_series(const SimulatedRun& run, const Measurement& measurement, const Window& window);

struct WrenchSeries {
  std::vector<double> times;
  std::vector<Wrench> simulated, measured;
  std::vector<double> force_error, torque_error;  ///< N, Nm
};
[[nodiscard]] WrenchSeries wrench_series(const SimulatedRun& run, const Measurement& measurement, const Window& window);

}  // namespace snug::validation
