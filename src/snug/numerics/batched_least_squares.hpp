// solve_batched: bounded least squares of simulations, whose derivatives are differences computed many at a time.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace snug::numerics {

/// Residuals of terms that share some unknowns and own others (LeastSquaresTerm), evaluated as a batch.
struct BatchedProblem {
  Eigen::VectorXd start, lower, upper, step;  ///< shared unknowns; step: of their central differences
  struct Term {
    Eigen::Index residuals = 1;
    Eigen::VectorXd own, own_step;  ///< often empty
    /// Rows that each own unknown changes, as runs {first, count}; empty: any may change all. Unknowns that share no
    /// row are moved together.
    std::vector<std::vector<std::pair<Eigen::Index, Eigen::Index>>> own_rows = {};
  };
  std::vector<Term> terms;

  struct Job {
    std::size_t term = 0;
    Eigen::VectorXd shared, own;
  };
  /// Residuals of each job, in their order; empty where a simulation failed. May use as many threads as it likes.
  std::function<std::vector<Eigen::VectorXd>(const std::vector<Job>&)> evaluate;
};

struct BatchedOptions {
  double tolerance = 1e-8;  ///< relative, of cost and unknowns: differences know no more
  int max_iterations = 30;
  /// The Jacobian is computed at the start alone (chord method), for simulations that take long: the search is over
  /// after two steps in a row that lower nothing. That in the result is of the start, too.
  bool fixed_jacobian = false;
  double loss_scale = 0.0;  ///< residuals of a term whose norm is larger weigh less and less; 0: plain squares
};

/// Derivatives of all terms at a point, by differences: [shared, own] columns; empty where a simulation failed. Steps
/// that would leave the bounds go to the bound only.
struct BatchedDerivatives {
  std::vector<Eigen::VectorXd> residuals;
  std::vector<Eigen::MatrixXd> jacobians;
  Eigen::VectorXd shared;                ///< where
  std::vector<Eigen::VectorXd> own;      ///< of each term
  std::vector<Eigen::MatrixXd> reduced;  ///< triangular factor of [J r], with the same sums of squares and products
};

struct BatchedResult {
  Eigen::VectorXd x;
  std::vector<Eigen::VectorXd> own;
  double cost = 0.0;            ///< sum of squares
  Eigen::MatrixXd information;  ///< of the shared unknowns, own ones eliminated (LeastSquaresResult)
  BatchedDerivatives at;        ///< there
  bool has_converged = false;
  int iterations = 0;
  std::string message;
};

/// Levenberg-Marquardt within bounds (Ceres), one thread of its own: the same residuals give the same bytes.
[[nodiscard]] BatchedResult solve_batched(const BatchedProblem& problem, const BatchedOptions& options = {});

[[nodiscard]] BatchedDerivatives differentiate(const BatchedProblem& problem, const Eigen::VectorXd& shared,
                                               const std::vector<Eigen::VectorXd>& own);
/// J^T J of the shared unknowns with those of each term eliminated.
[[nodiscard]] Eigen::MatrixXd shared_information(const BatchedDerivatives& at, Eigen::Index shared);
/// How far the minimum of the shared unknowns moves, to first order, when each term's residuals change by this much and
/// its own unknowns follow. A term whose change has another size counts as unchanged.
[[nodiscard]] Eigen::VectorXd shared_step(const BatchedDerivatives& at, const std::vector<Eigen::VectorXd>& changes,
                                          Eigen::Index shared);
/// Of the shared unknowns at the start of a problem, which is a minimum, residuals in units of their noise: the inverse
/// of shared_information, larger where the sum of squares rises by less than that says or strays from a parabola, as it
/// does where residuals jump. `excess`: of the sum of squares at the start over what noise explains; where the sum is
/// rough (it strays by more than one) the least of it may be as far away, at most twenty deviations. Own unknowns
/// follow by their slopes. `found`: derivatives at the start.
[[nodiscard]] Eigen::MatrixXd squares_covariance(const BatchedProblem& at, const BatchedDerivatives& found,
                                                 double excess = 0.0);

}  // namespace snug::numerics
