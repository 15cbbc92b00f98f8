// fit_linear: least squares with covariance, and which groups of rows do not belong to the rest.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace snug::calibration::internal {

/// What the rows of a matrix say least about.
struct Weakest {
  double spread = 0.0;        ///< smallest singular value / sqrt(groups)
  Eigen::VectorXd direction;  ///< its direction in x
};
[[nodiscard]] Weakest find_weakest(const Eigen::MatrixXd& A, std::size_t groups);

struct LinearFit {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;         ///< of x; noise estimated from the residuals
  double sigma = 0.0;                 ///< standard deviation of one row's residual
  std::vector<std::size_t> outliers;  ///< groups whose residual no noise of the others explains
  double spread = 0.0;                ///< smallest singular value of A / sqrt(groups)
  Eigen::VectorXd weakest;            ///< its direction in x
};

/// min |A x - b|. Rows come in groups of `group` (one measurement). Outliers are found against a robust fit (absolute
/// residuals): beyond 6 standard deviations, which are taken from the median.
[[nodiscard]] LinearFit fit_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index group);

}  // namespace snug::calibration::internal
