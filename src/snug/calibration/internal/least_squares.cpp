// solve_least_squares: Ceres behind one function.
#include "snug/calibration/internal/least_squares.hpp"

#include <ceres/ceres.h>

#include <memory>

namespace snug::calibration::internal {
namespace {

/// All residuals and their Jacobian at one x, shared by the groups.
struct Evaluation {
  Eigen::VectorXd at;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  bool has_jacobian = false;
};

/// One group of residuals.
class Group final : public ceres::CostFunction {
 public:
  Group(const LeastSquaresProblem& problem, Evaluation& shared, Eigen::Index first, Eigen::Index unknowns)
      : problem_(problem), shared_(shared), first_(first) {
    set_num_residuals(static_cast<int>(problem.group));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index unknowns = parameter_block_sizes()[0];
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], unknowns);
    if (shared_.at.size() != unknowns || shared_.at != x) {
      shared_.at = x;
      shared_.residual = problem_.residual(shared_.at);
      shared_.has_jacobian = false;
    }
    Eigen::Map<Eigen::VectorXd>(residuals, problem_.group) = shared_.residual.segment(first_, problem_.group);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      if (!shared_.has_jacobian) shared_.jacobian = problem_.jacobian(shared_.at);
      shared_.has_jacobian = true;
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor>(jacobians[0], problem_.group, unknowns) =
          shared_.jacobian.middleRows(first_, problem_.group);
    }
    return true;
  }

 private:
  const LeastSquaresProblem& problem_;
  Evaluation& shared_;
  Eigen::Index first_;
};

}  // namespace

LeastSquaresResult solve_least_squares(const LeastSquaresProblem& problem, const Eigen::VectorXd& start) {
  LeastSquaresResult result;
  result.x = start;
  Evaluation shared;
  ceres::Problem ceres_problem;
  const Eigen::Index rows = problem.residual(start).size();
  for (Eigen::Index first = 0; first < rows; first += problem.group) {
    auto group = std::make_unique<Group>(problem, shared, first, start.size());
    auto loss = problem.loss_scale > 0.0 ? std::make_unique<ceres::CauchyLoss>(problem.loss_scale) : nullptr;
    ceres_problem.AddResidualBlock(group.release(), loss.release(), result.x.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  // Running out of iterations with tolerances of rounding is no failure when nothing moves any more.
  result.has_converged =
      summary.IsSolutionUsable() && result.x.allFinite() &&
      (summary.termination_type == ceres::CONVERGENCE || summary.iterations.back().relative_decrease < 1e-6 ||
       summary.iterations.back().step_norm < 1e-9);
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.message = summary.message;
  return result;
}

}  // namespace snug::calibration::internal
