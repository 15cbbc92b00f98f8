// solve_batched: Ceres with differences that are evaluated as one batch before each iteration.
#include "snug/numerics/batched_least_squares.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "snug/core/check.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::numerics {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

using RowRun = std::pair<Eigen::Index, Eigen::Index>;

bool share_rows(const std::vector<RowRun>& a, const std::vector<RowRun>& b) {
  for (const RowRun& p : a)
    for (const RowRun& q : b)
      if (p.first < q.first + q.second && q.first < p.first + p.second) return true;
  return false;
}

/// Own unknowns in groups of which no two share a row (Curtis, Powell and Reid, 1974), each in the first that takes it.
std::vector<std::vector<Eigen::Index>> unknowns_apart(const BatchedProblem::Term& term) {
  std::vector<std::vector<Eigen::Index>> groups;
  const auto rows_of = [&](Eigen::Index j) { return term.own_rows[static_cast<std::size_t>(j)]; };
  for (Eigen::Index j = 0; j < term.own.size(); ++j) {
    const auto takes_it = [&](const std::vector<Eigen::Index>& group) {
      if (term.own_rows.empty()) return false;
      return std::none_of(group.begin(), group.end(),
                          [&](Eigen::Index k) { return share_rows(rows_of(j), rows_of(k)); });
    };
    const auto group = std::find_if(groups.begin(), groups.end(), takes_it);
    if (group == groups.end())
      groups.push_back({j});
    else
      group->push_back(j);
  }
  return groups;
}

/// What the batch found at the unknowns of last time.
struct Batch {
  const BatchedProblem& problem;
  bool fixed_jacobian = false;
  std::shared_ptr<const BatchedDerivatives> found;  ///< without derivatives, where only the cost was asked for
  std::shared_ptr<const BatchedDerivatives> last;   ///< with derivatives
};

/// Rows that Ceres gets of a term: of many residuals only as many as have the same sum of squares and slopes.
Eigen::Index reduced_rows(const BatchedProblem& problem, std::size_t term) {
  const BatchedProblem::Term& of = problem.terms[term];
  return std::min(of.residuals, problem.start.size() + of.own.size() + 1);
}

Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& A) { return A.rows() > A.cols() ? triangular_factor(A) : A; }

/// Triangular factor of [J r]. Rows that the same own unknowns change are reduced first, without the columns of the
/// others, which are zero there.
Eigen::MatrixXd reduce(const BatchedProblem::Term& term, const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
  const Eigen::Index own = term.own.size(), shared = J.cols() - own;
  std::vector<Eigen::Index> cuts{0, r.size()};
  for (const std::vector<RowRun>& runs : term.own_rows)
    for (const auto& [first, count] : runs) cuts.insert(cuts.end(), {first, first + count});
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  Eigen::MatrixXd all(0, J.cols() + 1);
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    const Eigen::Index first = cuts[c], count = cuts[c + 1] - first;
    std::vector<Eigen::Index> columns;
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      const bool is_zero = j >= shared && !term.own_rows.empty() &&
                           !share_rows(term.own_rows[static_cast<std::size_t>(j - shared)], {{first, count}});
      if (!is_zero) columns.push_back(j);
    }
    Eigen::MatrixXd part(count, static_cast<Eigen::Index>(columns.size()) + 1);
    part << J.middleRows(first, count)(Eigen::all, columns), r.segment(first, count);
    const Eigen::MatrixXd R = triangle_of(part);
    columns.push_back(J.cols());
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(R.rows(), all.cols());
    wide(Eigen::all, columns) = R;
    all.conservativeResize(all.rows() + R.rows(), Eigen::NoChange);
    all.bottomRows(R.rows()) = wide;
  }
  const Eigen::MatrixXd R = triangle_of(all);
  Eigen::MatrixXd whole =
      Eigen::MatrixXd::Zero(std::min(r.size(), all.cols()), all.cols());  // as many rows as Ceres knows
  whole.topRows(R.rows()) = R;
  return whole;
}

std::vector<Eigen::VectorXd> evaluate_at(const BatchedProblem& problem, const Eigen::VectorXd& shared,
                                         const std::vector<Eigen::VectorXd>& own) {
  std::vector<BatchedProblem::Job> jobs;
  for (std::size_t i = 0; i < problem.terms.size(); ++i) jobs.push_back({i, shared, own[i]});
  return problem.evaluate(jobs);
}

/// Shared unknowns, then those of each term.
std::vector<Eigen::VectorXd> own_parts(const BatchedProblem& problem, const Eigen::VectorXd& unknowns) {
  std::vector<Eigen::VectorXd> own;
  Eigen::Index first = problem.start.size();
  for (const BatchedProblem::Term& term : problem.terms) {
    own.push_back(unknowns.segment(first, term.own.size()));
    first += term.own.size();
  }
  return own;
}

void reduce_all(const BatchedProblem& problem, BatchedDerivatives& at) {
  at.reduced.resize(problem.terms.size());
  for (std::size_t i = 0; i < problem.terms.size(); ++i) {
    const Eigen::VectorXd& r = at.residuals[i];
    const Eigen::MatrixXd& J = at.jacobians[i];
    if (r.size() == problem.terms[i].residuals && J.rows() == r.size() && J.allFinite() && r.allFinite())
      at.reduced[i] = reduce(problem.terms[i], J, r);
  }
}

/// Residuals there, with the Jacobian of elsewhere.
BatchedDerivatives with_jacobian_of(const BatchedProblem& problem, const BatchedDerivatives& elsewhere,
                                    const Eigen::VectorXd& shared, const std::vector<Eigen::VectorXd>& own) {
  BatchedDerivatives found;
  found.residuals = evaluate_at(problem, shared, own);
  found.jacobians = elsewhere.jacobians;
  found.shared = shared;
  found.own = own;
  reduce_all(problem, found);
  return found;
}

}  // namespace

BatchedDerivatives differentiate(const BatchedProblem& problem, const Eigen::VectorXd& shared,
                                 const std::vector<Eigen::VectorXd>& own) {
  const Eigen::Index n = shared.size();
  for (const BatchedProblem::Term& term : problem.terms)
    SNUG_CHECK(term.own_rows.empty() || term.own_rows.size() == static_cast<std::size_t>(term.own.size()),
               "rows are named of all own unknowns or of none");
  std::vector<BatchedProblem::Job> jobs;
  struct Column {
    std::size_t term, plus, minus;
    Eigen::Index column;
    double span;
    std::vector<RowRun> rows = {};  // empty: all
  };
  std::vector<Column> columns;
  for (std::size_t i = 0; i < problem.terms.size(); ++i) jobs.push_back({i, shared, own[i]});
  const Eigen::VectorXd up = (shared + problem.step).cwiseMin(problem.upper);
  const Eigen::VectorXd down = (shared - problem.step).cwiseMax(problem.lower);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < problem.terms.size(); ++i) {
      BatchedProblem::Job plus{i, shared, own[i]}, minus = plus;
      plus.shared[j] = up[j], minus.shared[j] = down[j];
      columns.push_back({i, jobs.size(), jobs.size() + 1, j, up[j] - down[j]});
      jobs.push_back(std::move(plus));
      jobs.push_back(std::move(minus));
    }
  }
  for (std::size_t i = 0; i < problem.terms.size(); ++i) {
    for (const std::vector<Eigen::Index>& together : unknowns_apart(problem.terms[i])) {
      BatchedProblem::Job plus{i, shared, own[i]}, minus = plus;
      for (const Eigen::Index j : together) {
        const double h = problem.terms[i].own_step[j];
        plus.own[j] += h, minus.own[j] -= h;
        columns.push_back({i, jobs.size(), jobs.size() + 1, n + j, 2.0 * h});
        if (!problem.terms[i].own_rows.empty())
          columns.back().rows = problem.terms[i].own_rows[static_cast<std::size_t>(j)];
      }
      jobs.push_back(std::move(plus));
      jobs.push_back(std::move(minus));
    }
  }
  std::vector<Eigen::VectorXd> values = problem.evaluate(jobs);
  SNUG_CHECK(values.size() == jobs.size(), "each job of a batch has residuals");
  BatchedDerivatives found;
  found.shared = shared;
  found.own = own;
  for (std::size_t i = 0; i < problem.terms.size(); ++i)
    found.jacobians.push_back(Eigen::MatrixXd::Zero(values[i].size(), n + own[i].size()));
  for (const Column& column : columns) {
    const Eigen::VectorXd &plus = values[column.plus], &minus = values[column.minus];
    Eigen::MatrixXd& J = found.jacobians[column.term];
    if (plus.size() != J.rows() || minus.size() != J.rows()) J.resize(0, 0);
    if (J.cols() == 0) continue;
    if (column.rows.empty()) J.col(column.column) = (plus - minus) / column.span;
    for (const auto& [first, count] : column.rows)
      J.col(column.column).segment(first, count) =
          (plus.segment(first, count) - minus.segment(first, count)) / column.span;
  }
  values.resize(problem.terms.size());
  found.residuals = std::move(values);
  reduce_all(problem, found);
  return found;
}

namespace {

/// Ceres asks for residuals and derivatives term by term; before it does, this computes all of them at once.
class Prepare final : public ceres::EvaluationCallback {
 public:
  Prepare(Batch& batch, const Eigen::VectorXd& unknowns) : batch_(batch), unknowns_(unknowns) {}
  void PrepareForEvaluation(bool with_jacobians, bool is_new_point) override {
    if (!is_new_point && batch_.found && (!with_jacobians || !batch_.found->jacobians.empty())) return;
    const Eigen::VectorXd shared = unknowns_.head(batch_.problem.start.size());
    const std::vector<Eigen::VectorXd> own = own_parts(batch_.problem, unknowns_);
    if (batch_.last && batch_.last->shared == shared && batch_.last->own == own) {
      batch_.found = batch_.last;
      return;
    }
    if (with_jacobians) {
      batch_.found = std::make_shared<const BatchedDerivatives>(
          batch_.fixed_jacobian && batch_.last ? with_jacobian_of(batch_.problem, *batch_.last, shared, own)
                                               : differentiate(batch_.problem, shared, own));
      batch_.last = batch_.found;
    } else {
      BatchedDerivatives at;
      at.residuals = evaluate_at(batch_.problem, shared, own);
      batch_.found = std::make_shared<const BatchedDerivatives>(std::move(at));
    }
  }

 private:
  Batch& batch_;
  const Eigen::VectorXd& unknowns_;  ///< where Ceres keeps them
};

/// With a Jacobian of elsewhere, two steps in a row that lower nothing are enough.
class StopWithoutGain final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    failures_ = summary.step_is_successful ? 0 : failures_ + 1;
    return failures_ < 2 ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  int failures_ = 0;
};

class BatchedTermCost final : public ceres::CostFunction {
 public:
  BatchedTermCost(const Batch& batch, std::size_t term) : batch_(batch), term_(term) {
    const BatchedProblem::Term& of = batch.problem.terms[term];
    set_num_residuals(static_cast<int>(reduced_rows(batch.problem, term)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(batch.problem.start.size()));
    if (of.own.size() > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(of.own.size()));
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd& r = batch_.found->residuals[term_];
    if (r.size() != batch_.problem.terms[term_].residuals || !r.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd> given(residuals, num_residuals());
    if (jacobians == nullptr) {  // what counts is the sum of squares
      given.setZero();
      given[0] = r.norm();
      return true;
    }
    const Eigen::MatrixXd& R = batch_.found->reduced[term_];
    if (R.rows() != given.size()) return false;
    given = R.col(R.cols() - 1);
    const Eigen::Index n = batch_.problem.start.size(), own = R.cols() - 1 - n;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor>(jacobians[0], R.rows(), n) = R.leftCols(n);
    if (own > 0 && jacobians[1] != nullptr) Eigen::Map<RowMajor>(jacobians[1], R.rows(), own) = R.middleCols(n, own);
    return true;
  }

 private:
  const Batch& batch_;
  std::size_t term_;
};

/// `has_own`: some term has unknowns of its own.
ceres::Solver::Options solver_options(const BatchedOptions& options, bool has_own) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = has_own ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = options.tolerance;
  if (options.fixed_jacobian) solver.max_num_line_search_step_size_iterations = 3;
  return solver;
}

}  // namespace

BatchedResult solve_batched(const BatchedProblem& given, const BatchedOptions& options) {
  Batch batch{given, options.fixed_jacobian, {}, {}};
  // In one run of memory, as Ceres sorts unknowns by their addresses.
  Eigen::Index count = given.start.size();
  for (const BatchedProblem::Term& term : given.terms) count += term.own.size();
  Eigen::VectorXd unknowns(count);
  unknowns.head(given.start.size()) = given.start;
  Prepare prepare(batch, unknowns);
  ceres::Problem::Options ownership;
  ownership.evaluation_callback = &prepare;
  ceres::Problem problem(ownership);
  auto* ordering = new ceres::ParameterBlockOrdering;  // Ceres takes it over
  ordering->AddElementToGroup(unknowns.data(), 1);
  Eigen::Index first = given.start.size();
  for (std::size_t i = 0; i < given.terms.size(); ++i) {
    std::vector<double*> blocks{unknowns.data()};
    const Eigen::VectorXd& own = given.terms[i].own;
    if (own.size() > 0) {
      unknowns.segment(first, own.size()) = own;
      blocks.push_back(unknowns.data() + first);
      ordering->AddElementToGroup(blocks.back(), 0);
      first += own.size();
    }
    auto loss = options.loss_scale > 0.0 ? std::make_unique<ceres::CauchyLoss>(options.loss_scale) : nullptr;
    problem.AddResidualBlock(new BatchedTermCost(batch, i), loss.release(), blocks);
  }
  for (int j = 0; j < static_cast<int>(given.start.size()); ++j) {
    problem.SetParameterLowerBound(unknowns.data(), j, given.lower[j]);
    problem.SetParameterUpperBound(unknowns.data(), j, given.upper[j]);
  }
  ceres::Solver::Options solver = solver_options(options, count > given.start.size());
  solver.linear_solver_ordering.reset(ordering);
  StopWithoutGain stop;
  if (options.fixed_jacobian) solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  BatchedResult result;
  result.x = unknowns.head(given.start.size());
  result.own = own_parts(given, unknowns);
  result.has_converged = summary.IsSolutionUsable() && result.x.allFinite() &&
                         (summary.termination_type == ceres::CONVERGENCE || summary.iterations.size() > 1);
  result.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  result.message = summary.message;
  if (!summary.IsSolutionUsable()) return result;
  const bool is_known = batch.last && batch.last->shared == result.x && batch.last->own == result.own;
  if (is_known)
    result.at = *batch.last;
  else if (options.fixed_jacobian && batch.last)
    result.at = with_jacobian_of(given, *batch.last, result.x, result.own);
  else
    result.at = differentiate(given, result.x, result.own);
  for (const Eigen::VectorXd& r : result.at.residuals) result.cost += r.squaredNorm();
  result.information = shared_information(result.at, given.start.size());
  return result;
}

}  // namespace snug::numerics
