// solve_least_squares: non-linear least squares of a packaged solver.
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

namespace snug::calibration::internal {

struct LeastSquaresProblem {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residual;
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> jacobian;
  Eigen::Index group = 1;   ///< residuals that belong together, for the loss
  double loss_scale = 0.0;  ///< groups larger than this weigh less and less (Cauchy); 0: plain squares
};

struct LeastSquaresResult {
  Eigen::VectorXd x;
  bool has_converged = false;
  int iterations = 0;
  std::string message;
};

/// Levenberg-Marquardt, one thread.
[[nodiscard]] LeastSquaresResult solve_least_squares(const LeastSquaresProblem& problem, const Eigen::VectorXd& start);

}  // namespace snug::calibration::internal
