// solve_least_squares: non-linear least squares of a packaged solver, in terms that share some unknowns and own others.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace snug::numerics {

/// Residuals that belong together. Each term depends on the shared unknowns and on `own` ones that no other term knows.
struct LeastSquaresTerm {
  Eigen::Index residuals = 1;
  Eigen::VectorXd own;  ///< where its own unknowns start; often empty
  /// Writes the residuals to r (sized) and, when J is not null, their derivatives [shared, own] to *J (sized).
  std::function<void(const Eigen::VectorXd& shared, const Eigen::VectorXd& own, Eigen::VectorXd& r, Eigen::MatrixXd* J)>
      evaluate;
};

struct LeastSquaresOptions {
  double loss_scale = 0.0;   ///< terms whose norm is larger weigh less and less (Cauchy); 0: plain squares
  double tolerance = 1e-14;  ///< relative, of cost, unknowns and gradient
  int max_iterations = 100;
};

struct LeastSquaresResult {
  Eigen::VectorXd x;                 ///< shared unknowns
  std::vector<Eigen::VectorXd> own;  ///< of each term
  double cost = 0.0;                 ///< sum of squares, without loss
  /// Of the shared unknowns with the own ones eliminated (Schur complement of J^T J, without loss): its inverse is
  /// their covariance when the residuals have unit variance.
  Eigen::MatrixXd information;
  bool has_converged = false;
  int iterations = 0;
  std::string message;
};

/// Levenberg-Marquardt, one thread: the same input gives the same bytes.
[[nodiscard]] LeastSquaresResult solve_least_squares(const std::vector<LeastSquaresTerm>& terms,
                                                     const Eigen::VectorXd& start,
                                                     const LeastSquaresOptions& options = {});

}  // namespace snug::numerics
