// Force sensor from readings at rest: two linear fits, and what follows from them.
#include "snug/calibration/force_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "snug/calibration/internal/complaints.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/calibration/internal/linear_fit.hpp"
#include "snug/core/input_error.hpp"

namespace snug::calibration {
namespace {

/// Between what the sensor reads and N: beyond it the mass or the readings have another unit.
constexpr double kLargestScale = 10.0;

/// Directions of gravity in the sensor's frame, m/s^2.
std::vector<Vector3> gravities(const Table& table, double gravity) {
  std::vector<Vector3> g_S;
  for (const std::vector<double>& row : table.rows)
    g_S.push_back(exp_rotation({row[0], row[1], row[2]}).transpose() * Vector3(0.0, 0.0, -gravity));
  return g_S;
}

Vector3 part(const std::vector<double>& row, std::size_t first) { return {row[first], row[first + 1], row[first + 2]}; }

/// reading = offset + slope * gravity along each axis: x = (offset, slope).
internal::LinearFit fit_forces(const Table& table, const std::vector<Vector3>& g_S, double gravity) {
  const auto n = static_cast<Eigen::Index>(g_S.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, 6);
  Eigen::VectorXd b(3 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    A.block<3, 3>(3 * k, 0).setIdentity();
    A.block<3, 3>(3 * k, 3) = (g_S[i] / gravity).asDiagonal();
    b.segment<3>(3 * k) = part(table.rows[i], 3);
  }
  return internal::fit_linear(A, b, 3);
}

/// reading = offset + h x gravity, h = mass * com: x = (offset, h).
internal::LinearFit fit_torques(const Table& table, const std::vector<Vector3>& g_S, double gravity) {
  const auto n = static_cast<Eigen::Index>(g_S.size());
  Eigen::MatrixXd A(3 * n, 6);
  Eigen::VectorXd b(3 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    A.block<3, 3>(3 * k, 0).setIdentity();
    A.block<3, 3>(3 * k, 3) = -skew(g_S[i] / gravity);
    b.segment<3>(3 * k) = part(table.rows[i], 6);
  }
  return internal::fit_linear(A, b, 3);
}

void check_ranges(const Table& table) {
  for (std::size_t i = 0; i < 3; ++i) {
    internal::check_range(table, i, internal::kLargestTurn, "a part of a rotation vector in rad");
    internal::check_range(table, 3 + i, internal::kLargestForce,
                          "a force in N, at most " + internal::to_text(internal::kLargestForce));
    internal::check_range(table, 6 + i, internal::kLargestTorque,
                          "a torque in Nm, at most " + internal::to_text(internal::kLargestTorque));
  }
}

void check_orientations(const Table& table, const std::vector<Vector3>& g_S, double gravity) {
  for (int axis = 0; axis < 3; ++axis) {
    double low = gravity, high = -gravity;
    for (const Vector3& g : g_S) {
      low = std::min(low, g(axis));
      high = std::max(high, g(axis));
    }
    if (high - low < 0.5 * gravity)
      throw InputError(table.name, "",
                       std::string("orientations in which gravity along the sensor's ") + "xyz"[axis] +
                           " axis changes by less than half of g",
                       "orientations with each axis up and down: else offset and scale along it are not determined");
  }
}

}  // namespace

std::vector<std::string> force_sensor_columns() { return {"rx", "ry", "rz", "fx", "fy", "fz", "tx", "ty", "tz"}; }

ForceSensorFit fit_force_sensor(const Table& table, std::optional<double> known_mass, double gravity) {
  internal::check_count(table, 4, "orientations");
  check_ranges(table);
  const std::vector<Vector3> g_S = gravities(table, gravity);
  check_orientations(table, g_S, gravity);
  const internal::LinearFit forces = fit_forces(table, g_S, gravity);
  const internal::LinearFit torques = fit_torques(table, g_S, gravity);
  std::vector<std::size_t> outliers = forces.outliers;
  outliers.insert(outliers.end(), torques.outliers.begin(), torques.outliers.end());
  std::sort(outliers.begin(), outliers.end());
  outliers.erase(std::unique(outliers.begin(), outliers.end()), outliers.end());
  internal::check_outliers(table, outliers);

  ForceSensorFit fit;
  const Vector3 weight = forces.x.tail<3>();  // N, m g / scale along each axis
  if (!(weight.minCoeff() > 5.0 * std::sqrt(forces.covariance.diagonal().tail<3>().maxCoeff()) &&
        weight.minCoeff() > 0.0))
    throw InputError(table.name, "fx,fy,fz", "a weight of " + internal::to_text(weight) + " N along the three axes",
                     "readings that pull along gravity, by more than their noise: check signs and frames");
  fit.force_offset = forces.x.head<3>();
  fit.force_offset_deviation = forces.covariance.diagonal().head<3>().cwiseSqrt();
  const Matrix3 C = forces.covariance.bottomRightCorner<3, 3>();
  // Relative to the weights everything is linear: log mass, log scale.
  const Vector3 inverse = weight.cwiseInverse();
  const Matrix3 relative = inverse.asDiagonal() * C * inverse.asDiagonal();
  const double mean_weight = std::cbrt(weight.prod());
  fit.mass = known_mass.value_or(mean_weight / gravity);
  fit.scale = fit.mass * gravity * inverse;
  if (!(fit.scale.minCoeff() >= 1.0 / kLargestScale && fit.scale.maxCoeff() <= kLargestScale))
    throw InputError(table.name, "fx,fy,fz",
                     "readings of " + internal::to_text(weight) + " N along the three axes for " +
                         internal::to_text(fit.mass) + " kg",
                     "forces in N and a mass in kg");
  const Vector3 third = Vector3::Constant(1.0 / 3.0);
  fit.mass_deviation = known_mass ? 0.0 : fit.mass * std::sqrt(third.dot(relative * third));
  for (int i = 0; i < 3; ++i) {
    const Vector3 weights = (known_mass ? Vector3(Vector3::Zero()) : third) - Vector3::Unit(i);
    fit.scale_deviation(i) = fit.scale(i) * std::sqrt(weights.dot(relative * weights));
  }
  const Vector3 moment = torques.x.tail<3>();  // Nm, m g com
  fit.torque_offset = torques.x.head<3>();
  fit.torque_offset_deviation = torques.covariance.diagonal().head<3>().cwiseSqrt();
  fit.com = moment / (fit.mass * gravity);
  if (!(fit.com.norm() <= internal::kLongestTool))
    throw InputError(table.name, "tx,ty,tz", "a centre of mass at " + internal::to_text(fit.com) + " m of the sensor",
                     "torques in Nm that put it within " + internal::to_text(internal::kLongestTool) + " m");
  const double mass_part = fit.mass_deviation / fit.mass;
  fit.com_deviation =
      (torques.covariance.diagonal().tail<3>() / std::pow(fit.mass * gravity, 2) + (mass_part * fit.com).cwiseAbs2())
          .cwiseSqrt();
  fit.force_noise = forces.sigma;
  fit.torque_noise = torques.sigma;
  return fit;
}

}  // namespace snug::calibration
