// Misfit of one static pose: how far pose and wrench must move, in units of their noise, to be in balance.
#pragma once

#include <vector>

#include "snug/identification/internal/stiffness_form.hpp"
#include "snug/identification/static_poses.hpp"

namespace snug::identification::internal {

/// Noise carried to the frame S1 that the stiffness lives in.
struct NoiseAtS1 {
  Vector6 pose_S;  ///< variances of the lip's pose: place in E (3), turn (3)
  Matrix6 pose;    ///< covariance of the body twist of S1
  Matrix6 wrench;  ///< covariance of a sensor's wrench, at S1
  Matrix6 to_S1;   ///< twist of S to twist of S1: the transposed of cup::wrench_transform
  Matrix6 from_S;  ///< wrench in S to wrench in S1
};
[[nodiscard]] NoiseAtS1 carry_noise(const MeasurementNoise& noise, const CupFrames& frames);

/// What balances the spring at S1.
struct Balance {
  Pose X_ES;  ///< measured
  Pose H;     ///< S2_H_S1 there
  bool is_gravity = false;
  Vector6 wrench_S1 = Vector6::Zero();  ///< sensor: of the cup on the package
  Vector3 weight_S2 = Vector3::Zero();  ///< gravity: N
  Vector3 p_S1Scm = Vector3::Zero();    ///< gravity: m

  /// Wrench that the cup must supply at this deformation, and its derivative by the body twist of S1.
  [[nodiscard]] Vector6 wanted(const Pose& H) const;
  [[nodiscard]] Matrix6 wanted_tangent(const Pose& H) const;
};
[[nodiscard]] std::vector<Balance> make_balances(const StaticPoses& poses, WrenchSource source);

struct Misfit {
  Vector6 residual;  ///< of unit covariance when only noise is left; its square is the misfit
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;  ///< by the numbers of the form; the gradient it gives is exact
  Matrix6 whitening;  ///< of what the wrench is off by at S1; minus its derivative by it
};
/// The nearest balanced pose and wrench (Gauss-Helmert iteration, docs/theory/identification.md, section 4).
[[nodiscard]] Misfit compute_misfit(const Balance& balance, const Matrix6& K, const NoiseAtS1& noise,
                                    const CupFrames& frames, const Form* form);

/// Measured less predicted pose: the body twist of S from the equilibrium near the measured pose to that pose.
[[nodiscard]] Vector6 compute_prediction_error(const Balance& balance, const Matrix6& K, const CupFrames& frames);

}  // namespace snug::identification::internal
