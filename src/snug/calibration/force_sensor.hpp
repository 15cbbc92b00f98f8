// Force sensor: offsets, scales and the load it carries, from readings at rest in several orientations.
#pragma once

#include <optional>

#include "snug/core/table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::calibration {

/// The true load on the sensor is force = scale * (reading - force_offset), torque = reading - torque_offset.
struct ForceSensorFit {
  Vector3 force_offset = Vector3::Zero();   ///< N
  Vector3 torque_offset = Vector3::Zero();  ///< Nm
  Vector3 scale = Vector3::Ones();          ///< per axis
  double mass = 0.0;                        ///< kg
  Vector3 com = Vector3::Zero();            ///< m, in the sensor's frame
  /// Standard deviations of the same.
  Vector3 force_offset_deviation = Vector3::Zero();
  Vector3 torque_offset_deviation = Vector3::Zero();
  Vector3 scale_deviation = Vector3::Zero();
  double mass_deviation = 0.0;
  Vector3 com_deviation = Vector3::Zero();
  double force_noise = 0.0;   ///< N, of one reading
  double torque_noise = 0.0;  ///< Nm
};

/// Columns rx,ry,rz (rotation vector of the sensor's frame in W, z up) and fx,fy,fz,tx,ty,tz (readings at rest; a load
/// that hangs below pulls along gravity). At rest reading = force_offset + (m / scale) R^T g and torque_offset +
/// m com x R^T g. Only ratios of mass and scales show, so either `known_mass` fixes the mass [kg], or the geometric
/// mean of the scales is 1. InputError when there are fewer than four orientations, when gravity never changes along an
/// axis, or when some rows do not belong to the rest.
[[nodiscard]] ForceSensorFit fit_force_sensor(const Table& table, std::optional<double> known_mass,
                                              double gravity = 9.81);

[[nodiscard]] std::vector<std::string> force_sensor_columns();

}  // namespace snug::calibration
