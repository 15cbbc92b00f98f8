// solve_least_squares: Ceres behind one function.
#include "snug/numerics/least_squares.hpp"
#include "snug/numerics/dense.hpp"

#include <ceres/ceres.h>

#include <memory>

namespace snug::numerics {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One term for Ceres: one block of shared unknowns, and one of its own when it has any.
class TermCost final : public ceres::CostFunction {
 public:
  TermCost(const LeastSquaresTerm& term, Eigen::Index shared) : term_(term), shared_(shared) {
    set_num_residuals(static_cast<int>(term.residuals));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(shared));
    if (term.own.size() > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(term.own.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd shared = Eigen::Map<const Eigen::VectorXd>(parameters[0], shared_);
    Eigen::VectorXd own(term_.own.size());
    if (own.size() > 0) own = Eigen::Map<const Eigen::VectorXd>(parameters[1], own.size());
    Eigen::VectorXd r(term_.residuals);
    Eigen::MatrixXd J;
    if (jacobians != nullptr) J.resize(term_.residuals, shared_ + own.size());
    term_.evaluate(shared, own, r, jacobians != nullptr ? &J : nullptr);
    Eigen::Map<Eigen::VectorXd>(residuals, r.size()) = r;
    if (jacobians == nullptr) return r.allFinite();
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor>(jacobians[0], r.size(), shared_) = J.leftCols(shared_);
    if (own.size() > 0 && jacobians[1] != nullptr)
      Eigen::Map<RowMajor>(jacobians[1], r.size(), own.size()) = J.rightCols(own.size());
    return r.allFinite() && J.allFinite();
  }

 private:
  const LeastSquaresTerm& term_;
  Eigen::Index shared_;
};

/// Cost and information at the solution, the own unknowns of each term eliminated.
void weigh(const std::vector<LeastSquaresTerm>& terms, LeastSquaresResult& result) {
  const Eigen::Index n = result.x.size();
  result.information = Eigen::MatrixXd::Zero(n, n);
  result.cost = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Eigen::Index own = result.own[i].size();
    Eigen::VectorXd r(terms[i].residuals);
    Eigen::MatrixXd J(terms[i].residuals, n + own);
    terms[i].evaluate(result.x, result.own[i], r, &J);
    result.cost += r.squaredNorm();
    Eigen::MatrixXd shared = J.leftCols(n);
    if (own > 0) {
      // What the own unknowns can explain is taken out of the shared columns.
      const Eigen::MatrixXd of_own = J.rightCols(own);
      shared -= product(of_own, solve_by_qr(of_own, shared));
    }
    result.information += transposed_product(shared, shared);
  }
}

}  // namespace

LeastSquaresResult solve_least_squares(const std::vector<LeastSquaresTerm>& terms, const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options) {
  LeastSquaresResult result;
  // Ceres sorts unknowns by their addresses: in one run of memory their order is always the same, and so are the bytes.
  Eigen::Index count = start.size();
  for (const LeastSquaresTerm& term : terms) count += term.own.size();
  Eigen::VectorXd unknowns(count);
  unknowns.head(start.size()) = start;
  const bool has_own = count > start.size();
  ceres::Problem problem;
  auto* ordering = new ceres::ParameterBlockOrdering;  // Ceres takes it over
  ordering->AddElementToGroup(unknowns.data(), 1);
  Eigen::Index first = start.size();
  for (const LeastSquaresTerm& term : terms) {
    auto cost = std::make_unique<TermCost>(term, start.size());
    auto loss = options.loss_scale > 0.0 ? std::make_unique<ceres::CauchyLoss>(options.loss_scale) : nullptr;
    std::vector<double*> blocks{unknowns.data()};
    if (term.own.size() > 0) {
      unknowns.segment(first, term.own.size()) = term.own;
      blocks.push_back(unknowns.data() + first);
      ordering->AddElementToGroup(blocks.back(), 0);
      first += term.own.size();
    }
    problem.AddResidualBlock(cost.release(), loss.release(), blocks);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = has_own ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
  solver.linear_solver_ordering.reset(ordering);
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = options.tolerance;
  solver.gradient_tolerance = options.tolerance;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  result.x = unknowns.head(start.size());
  first = start.size();
  for (const LeastSquaresTerm& term : terms) {
    result.own.push_back(unknowns.segment(first, term.own.size()));
    first += term.own.size();
  }
  // Running out of iterations with tolerances of rounding is no failure when nothing moves any more.
  result.has_converged =
      summary.IsSolutionUsable() && result.x.allFinite() &&
      (summary.termination_type == ceres::CONVERGENCE || summary.iterations.back().relative_decrease < 1e-6 ||
       summary.iterations.back().step_norm < 1e-9);
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.message = summary.message;
  if (summary.IsSolutionUsable()) weigh(terms, result);
  return result;
}

}  // namespace snug::numerics
