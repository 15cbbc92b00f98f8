// ComplianceSums: the normal equations of the compliance fit, ready to be summed over any choice of poses.
#pragma once

#include <vector>

#include "snug/identification/internal/pose_misfit.hpp"

namespace snug::identification::internal {

/// How far numbers that the data does not tell may be from their prior, in sizes of the prior.
inline constexpr double kPriorWidth = 1000.0;

/// One pose as the compliance fit sees it: C g = e, with what the noise does to both.
struct CompliancePose {
  Vector6 g, e;
  Matrix6 e_by_pose;    ///< d e / d twist of S1
  Matrix6 g_by_pose;    ///< d g / d twist of S1
  Matrix6 g_by_wrench;  ///< d g / d wrench at S1; zero for gravity
};
[[nodiscard]] std::vector<CompliancePose> make_compliance_poses(const std::vector<Balance>& balances);

struct LinearEstimate {
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;  ///< from the noise declared
  /// Directions of theta in which the wrenches hold no more than their noise, one a column; none with good data. There
  /// theta stays at the prior, and the covariance is its width.
  Eigen::MatrixXd unknown;
};

/// Numbers of the form of C: weighted least squares, compensated for the noise of g; `weight` of each pose (0: left
/// out). `prior`: the stiffness that unknown directions stay near.
[[nodiscard]] LinearEstimate fit_compliance(const std::vector<CompliancePose>& poses, const std::vector<double>& weight,
                                            const NoiseAtS1& noise, const Form& form, const Matrix6& prior);

/// Poses that do not belong to the rest, by a fit that forgives them.
[[nodiscard]] std::vector<std::size_t> find_odd_poses(const std::vector<CompliancePose>& poses, const NoiseAtS1& noise,
                                                      const Form& form, const Matrix6& prior);

}  // namespace snug::identification::internal
