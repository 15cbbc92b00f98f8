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
    const Eigen::VectorXd residual = numerics::product(A, x) - b;
    Eigen::VectorXd weight(b.size());
    for (Eigen::Index k = 0; k < b.size() / group; ++k)
      weight.segment(k * group, group).setConstant(1.0 / std::sqrt(std::max(floor, group_size(residual, group, k))));
    const Eigen::MatrixXd weighted_A = A.array().colwise() * weight.array();
    const Eigen::VectorXd weighted_b = weight.cwiseProduct(b);
    x = numerics::solve_by_qr(weighted_A, weighted_b);
  }
  return x;
}

/// Singular values and vectors of a triangular factor: those of the matrix, at a third of what tall matrices take to
/// compile.
struct Singular {
  explicit Singular(const Eigen::MatrixXd& R) : svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV) {}
  Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd;

  [[nodiscard]] double least() const { return svd.singularValues()(svd.cols() - 1); }
  [[nodiscard]] Eigen::VectorXd weakest() const { return svd.matrixV().col(svd.cols() - 1); }
};

/// With rows of zeros where there are fewer than columns.
Eigen::MatrixXd made_tall(const Eigen::MatrixXd& A) {
  Eigen::MatrixXd tall = Eigen::MatrixXd::Zero(std::max(A.rows(), A.cols()), A.cols());
  tall.topRows(A.rows()) = A;
  return tall;
}

}  // namespace

Weakest find_weakest(const Eigen::MatrixXd& A, std::size_t groups) {
  const Singular singular(numerics::triangular_factor(made_tall(A)));
  return {singular.least() / std::sqrt(static_cast<double>(groups)), singular.weakest()};
}

LinearFit fit_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index group) {
  LinearFit fit;
  const Eigen::Index groups = b.size() / group;
  const Eigen::Index n = A.cols();
  Eigen::MatrixXd both(A.rows(), n + 1);
  both << A, b;
  const Eigen::MatrixXd R = numerics::triangular_factor(made_tall(both));
  const Singular singular(R.topLeftCorner(n, n));
  fit.spread = singular.least() / std::sqrt(static_cast<double>(groups));
  fit.weakest = singular.weakest();
  fit.x = singular.svd.solve(Eigen::VectorXd(R.col(n).head(n)));
  const Eigen::VectorXd residual = numerics::product(A, fit.x) - b;
  const double freedom = std::max(1.0, static_cast<double>(A.rows() - A.cols()));
  fit.sigma = std::sqrt(residual.squaredNorm() / freedom);
  const Eigen::VectorXd inverse = singular.svd.singularValues().cwiseMax(1e-300).cwiseInverse().cwiseAbs2();
  fit.covariance = fit.sigma * fit.sigma * numerics::congruence(singular.svd.matrixV(), inverse.asDiagonal());
  // Rounding of exact data is no outlier.
  const double floor = 1e-9 * std::max(1e-3, b.cwiseAbs().maxCoeff());
  const Eigen::VectorXd robust = numerics::product(A, fit_robustly(A, b, group, floor)) - b;
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k < groups; ++k) sizes.push_back(group_size(robust, group, k));
  fit.outliers = numerics::find_outliers(sizes, static_cast<int>(group), floor, static_cast<int>(A.cols()));
  return fit;
}

}  // namespace snug::calibration::internal
