// Free flight: Gauss-Newton on Euler's equations, linear least squares on the parabola.
#include "snug/identification/free_flight.hpp"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "snug/core/check.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::identification {
namespace {

constexpr int kIterations = 6;         // the first guess is near: two are enough, the rest costs nothing
constexpr double kLongestStep = 5e-3;  // s, of the integration: 1e-9 rad at 20 rad/s

using Rotations = std::vector<Matrix3>;

/// Rotation of a body that turns freely from R and w (in W), at each time after the first.
Rotations turn_freely(std::span<const double> times, const Matrix3& R, const Vector3& w, const Matrix3& inertia,
                      const Matrix3& inverse) {
  Rotations result{R};
  Matrix3 now = R;
  const Vector3 momentum = R * inertia * R.transpose() * w;  // of rotation, in W: it stays
  const auto velocity = [&](const Matrix3& at) { return Vector3(at * (inverse * (at.transpose() * momentum))); };
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double span = times[k] - times[k - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(span / kLongestStep)));
    const double dt = span / steps;
    for (int i = 0; i < steps; ++i) {
      // Midpoint with a third-order predictor: the error of a step is dt^3 / 24 |w|^3 times the spread of moments.
      const Matrix3 middle = exp_rotation(0.5 * dt * velocity(exp_rotation(0.25 * dt * velocity(now)) * now)) * now;
      now = exp_rotation(dt * velocity(middle)) * now;
    }
    result.push_back(now);
  }
  return result;
}

Eigen::VectorXd misfit(std::span<const record::PoseSample> poses, const Rotations& R) {
  Eigen::VectorXd r(3 * static_cast<Eigen::Index>(poses.size()));
  for (std::size_t k = 0; k < poses.size(); ++k)
    r.segment<3>(3 * static_cast<Eigen::Index>(k)) = log_rotation(poses[k].pose().R * R[k].transpose());
  return r;
}

}  // namespace

FlightStart fit_free_flight(std::span<const double> times, std::span<const record::PoseSample> poses,
                            const SpatialInertia& inertia, const Vector3& gravity) {
  SNUG_CHECK(times.size() == poses.size() && times.size() >= 3, "a flight has at least three poses");
  const Matrix3 inverse = inertia.inertia.inverse();
  FlightStart start;
  start.X_WB = poses.front().pose();
  Vector3 w = log_rotation(poses[2].pose().R * poses[0].pose().R.transpose()) / (times[2] - times[0]);
  Rotations R;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    R = turn_freely(times, start.X_WB.R, w, inertia.inertia, inverse);
    const Eigen::VectorXd r = misfit(poses, R);
    Eigen::MatrixXd J(r.size(), 6);
    constexpr double kShift = 1e-6;
    for (int j = 0; j < 6; ++j) {
      const Vector3 unit = Vector3::Unit(j % 3) * kShift;
      const Rotations moved = j < 3 ? turn_freely(times, exp_rotation(unit) * start.X_WB.R, w, inertia.inertia, inverse)
                                    : turn_freely(times, start.X_WB.R, w + unit, inertia.inertia, inverse);
      J.col(j) = (r - misfit(poses, moved)) / kShift;
    }
    const Vector6 change =
        numerics::solve_symmetric(numerics::transposed_product(J, J), numerics::transposed_product(J, r));
    start.X_WB.R = orthonormalized(exp_rotation(change.head<3>()) * start.X_WB.R);
    w += change.tail<3>();
    if (change.norm() < 1e-10) break;
  }
  R = turn_freely(times, start.X_WB.R, w, inertia.inertia, inverse);
  // p_k + R_k c - g t^2 / 2 = p_0 + v t, of the centre of mass.
  double n = 0.0, st = 0.0, stt = 0.0;
  Vector3 sp = Vector3::Zero(), spt = Vector3::Zero();
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k] - times[0];
    const Vector3 p = poses[k].p + R[k] * inertia.com - 0.5 * t * t * gravity;
    n += 1.0, st += t, stt += t * t, sp += p, spt += t * p;
  }
  const Vector3 velocity = (n * spt - st * sp) / (n * stt - st * st);
  const double freedom = std::max(1.0, 3.0 * n - 6.0);
  double square = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k] - times[0];
    square += (poses[k].p + R[k] * inertia.com - 0.5 * t * t * gravity - (sp - st * velocity) / n - t * velocity)
                  .squaredNorm();
  }
  start.position_rms = std::sqrt(square / freedom);
  start.rotation_rms = std::sqrt(misfit(poses, R).squaredNorm() / freedom);
  const Vector3 lever = start.X_WB.R * inertia.com;
  start.X_WB.p = (sp - st * velocity) / n - lever;
  start.V_WB = {velocity - w.cross(lever), w};
  return start;
}

}  // namespace snug::identification
