// fit_linear: least squares with covariance, and outliers against a robust fit.
#include "snug/calibration/internal/linear_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include "snug/numerics/dense.hpp"
#include "snug/numerics/outliers.hpp"

namespace snug::calibration::internal {
namespace {

constexpr int kRobustSteps = 20;

double group_size(const Eigen::VectorXd& residual, Eigen::Index group, Eigen::Index k) {
  return residual.segment(k * group, group).norm();
}

/// Least absolute group residuals, by weights 1 / |r|.
Eigen::VectorXd fit_robustly(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index group, double floor) {
  Eigen::VectorXd x = numerics::solve_by_qr(A, b);
  for (int step = 0; step < kRobustSteps; ++step) {
    const Eigen::VectorXd residual = A * x - b;
    Eigen::VectorXd weight(b.size());
    for (Eigen::Index k = 0; k < b.size() / group; ++k)
      weight.segment(k * group, group).setConstant(1.0 / std::sqrt(std::max(floor, group_size(residual, group, k))));
    const Eigen::MatrixXd weighted_A = weight.asDiagonal() * A;
    const Eigen::VectorXd weighted_b = weight.asDiagonal() * b;
    x = numerics::solve_by_qr(weighted_A, weighted_b);
  }
  return x;
}

}  // namespace

Weakest find_weakest(const Eigen::MatrixXd& A, std::size_t groups) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinV);
  return {svd.singularValues()(A.cols() - 1) / std::sqrt(static_cast<double>(groups)), svd.matrixV().col(A.cols() - 1)};
}

LinearFit fit_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index group) {
  LinearFit fit;
  const Eigen::Index groups = b.size() / group;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  fit.spread = svd.singularValues()(A.cols() - 1) / std::sqrt(static_cast<double>(groups));
  fit.weakest = svd.matrixV().col(A.cols() - 1);
  fit.x = svd.solve(b);
  const Eigen::VectorXd residual = A * fit.x - b;
  const double freedom = std::max(1.0, static_cast<double>(A.rows() - A.cols()));
  fit.sigma = std::sqrt(residual.squaredNorm() / freedom);
  const Eigen::VectorXd inverse = svd.singularValues().cwiseMax(1e-300).cwiseInverse().cwiseAbs2();
  fit.covariance = fit.sigma * fit.sigma * (svd.matrixV() * inverse.asDiagonal() * svd.matrixV().transpose());
  // Rounding of exact data is no outlier.
  const double floor = 1e-9 * std::max(1e-3, b.cwiseAbs().maxCoeff());
  const Eigen::VectorXd robust = A * fit_robustly(A, b, group, floor) - b;
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k < groups; ++k) sizes.push_back(group_size(robust, group, k));
  fit.outliers = numerics::find_outliers(sizes, static_cast<int>(group), floor, static_cast<int>(A.cols()));
  return fit;
}

}  // namespace snug::calibration::internal
