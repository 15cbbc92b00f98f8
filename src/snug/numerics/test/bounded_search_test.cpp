// Tests of searches without derivatives and of batched least squares, on functions whose least is known.
#include "snug/numerics/bounded_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/numerics/batched_least_squares.hpp"

namespace snug::numerics {
namespace {

using Eigen::VectorXd;

VectorXd two(double a, double b) { return (VectorXd(2) << a, b).finished(); }

TEST(BoundedSearch, FindsTheLeastOfABentValley) {
  const auto rosenbrock = [](const VectorXd& x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  };
  for (const SearchMethod method : {SearchMethod::Subplex, SearchMethod::ControlledRandom}) {
    SearchOptions options;
    options.method = method;
    options.evaluations = 5000;
    options.tolerance = 1e-7;
    const SearchResult found = minimize_bounded(rosenbrock, two(-1.0, 1.5), two(-2.0, -2.0), two(2.0, 2.0), options);
    EXPECT_NEAR(found.x[0], 1.0, 1e-2);
    EXPECT_NEAR(found.x[1], 1.0, 2e-2);
    EXPECT_EQ(minimize_bounded(rosenbrock, two(-1.0, 1.5), two(-2.0, -2.0), two(2.0, 2.0), options).x, found.x);
  }
}

TEST(BoundedSearch, StaysWithinBoundsAndTakesNoNumberAsTheWorst) {
  bool has_left = false;
  const auto cost = [&](const VectorXd& x) {
    has_left = has_left || x.minCoeff() < 0.5 || x.maxCoeff() > 2.0;
    return x[0] > 1.5 ? std::numeric_limits<double>::quiet_NaN() : x.sum();
  };
  const SearchResult found = minimize_bounded(cost, two(1.0, 1.0), two(0.5, 0.5), two(2.0, 2.0), {});
  EXPECT_FALSE(has_left);
  EXPECT_NEAR(found.cost, 1.0, 1e-3);
}

/// Decays a exp(-b t) + c of which each term has a c of its own.
BatchedProblem decays(const VectorXd& truth) {
  BatchedProblem problem;
  problem.start = two(0.5, 0.3);
  problem.lower = two(0.1, 0.1);
  problem.upper = two(5.0, 5.0);
  problem.step = two(1e-5, 1e-5);
  for (int i = 0; i < 3; ++i) problem.terms.push_back({20, VectorXd::Zero(1), VectorXd::Constant(1, 1e-5)});
  problem.evaluate = [truth](const std::vector<BatchedProblem::Job>& jobs) {
    std::vector<VectorXd> residuals;
    for (const BatchedProblem::Job& job : jobs) {
      VectorXd r(20);
      for (int k = 0; k < 20; ++k) {
        const double t = 0.1 * k, own = 0.4 * static_cast<double>(job.term);
        r[k] = job.shared[0] * std::exp(-job.shared[1] * t) + job.own[0] - truth[0] * std::exp(-truth[1] * t) - own;
      }
      residuals.push_back(r);
    }
    return residuals;
  };
  return problem;
}

TEST(BatchedLeastSquares, FindsSharedAndOwnUnknowns) {
  const BatchedResult found = solve_batched(decays(two(2.0, 1.3)));
  EXPECT_TRUE(found.has_converged);
  EXPECT_NEAR(found.x[0], 2.0, 1e-6);
  EXPECT_NEAR(found.x[1], 1.3, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.own[i][0], 0.4 * static_cast<double>(i), 1e-6);
  // What the own unknowns explain is no information: less than with all of them known.
  const BatchedDerivatives at = differentiate(decays(two(2.0, 1.3)), found.x, found.own);
  Eigen::MatrixXd alone = Eigen::MatrixXd::Zero(2, 2);
  for (const Eigen::MatrixXd& J : at.jacobians) alone += J.leftCols(2).transpose() * J.leftCols(2);
  EXPECT_LT(found.information(0, 0), alone(0, 0));
}

TEST(BatchedLeastSquares, AFixedJacobianFindsTheSameWithFewerSimulations) {
  std::size_t count = 0;
  const auto solve = [&](bool fixed_jacobian) {
    BatchedProblem problem = decays(two(2.0, 1.3));
    problem.start = two(1.9, 1.2);  // near: what a fixed Jacobian is for
    const auto evaluate = problem.evaluate;
    problem.evaluate = [&count, evaluate](const std::vector<BatchedProblem::Job>& jobs) {
      count += jobs.size();
      return evaluate(jobs);
    };
    count = 0;
    BatchedOptions options;
    options.fixed_jacobian = fixed_jacobian;
    return solve_batched(problem, options).x;
  };
  EXPECT_LT((solve(false) - two(2.0, 1.3)).norm(), 1e-6);
  const std::size_t with_differences = count;
  EXPECT_LT((solve(true) - two(2.0, 1.3)).norm(), 1e-6);
  EXPECT_LT(count, with_differences);
}

TEST(BatchedLeastSquares, EndsAtABoundWhenTheLeastIsBeyond) {
  BatchedProblem problem = decays(two(2.0, 1.3));
  problem.upper = two(5.0, 1.0);
  const BatchedResult found = solve_batched(problem);
  EXPECT_NEAR(found.x[1], 1.0, 1e-6);
}

TEST(BatchedLeastSquares, SaysSoWhenNothingCanBeSimulated) {
  BatchedProblem problem = decays(two(2.0, 1.3));
  problem.evaluate = [](const std::vector<BatchedProblem::Job>& jobs) { return std::vector<VectorXd>(jobs.size()); };
  EXPECT_FALSE(solve_batched(problem).has_converged);
}

TEST(BatchedLeastSquares, TheCovarianceOfLinearResidualsIsTheInverseOfTheirInformation) {
  BatchedProblem problem = decays(two(2.0, 1.3));
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(20, 2);
  problem.evaluate = [&](const std::vector<BatchedProblem::Job>& jobs) {
    std::vector<VectorXd> residuals;
    for (const BatchedProblem::Job& job : jobs)
      residuals.emplace_back(30.0 * (A * (job.shared - problem.start)).array() + 5.0 * job.own[0]);
    return residuals;
  };
  const std::vector<VectorXd> own(3, VectorXd::Zero(1));
  const BatchedDerivatives at = differentiate(problem, problem.start, own);
  const Eigen::MatrixXd C = squares_covariance(problem, at), information = shared_information(at, 2);
  EXPECT_LT((C * information - Eigen::MatrixXd::Identity(2, 2)).norm(), 1e-6);
}

TEST(BatchedLeastSquares, MovesUnknownsTogetherThatShareNoRow) {
  // Five rows each of their own, one unknown that changes all, and the expectation of each in a row at the end.
  constexpr Eigen::Index kBlocks = 4, kRows = 5, kOwn = kBlocks + 1;
  BatchedProblem problem;
  problem.start = problem.lower = problem.upper = problem.step = VectorXd(0);
  BatchedProblem::Term term{kBlocks * kRows + kOwn, VectorXd::LinSpaced(kOwn, 0.1, 0.5),
                            VectorXd::Constant(kOwn, 1e-4)};
  std::size_t jobs_done = 0;
  problem.evaluate = [&](const std::vector<BatchedProblem::Job>& jobs) {
    jobs_done += jobs.size();
    std::vector<VectorXd> residuals;
    for (const BatchedProblem::Job& job : jobs) {
      VectorXd r(kBlocks * kRows + kOwn);
      for (Eigen::Index k = 0; k < kBlocks * kRows; ++k)
        r[k] = std::sin(job.own[0] + static_cast<double>(k)) +
               std::exp(job.own[1 + k / kRows] * static_cast<double>(k % kRows));
      r.tail(kOwn) = 3.0 * job.own;
      residuals.push_back(r);
    }
    return residuals;
  };
  problem.terms = {term};
  const Eigen::MatrixXd one_by_one = differentiate(problem, problem.start, {term.own}).jacobians.front();
  EXPECT_EQ(jobs_done, 1U + 2U * kOwn);
  for (Eigen::Index j = 0; j < kOwn; ++j) {
    const Eigen::Index first = j == 0 ? 0 : (j - 1) * kRows, count = j == 0 ? kBlocks * kRows : kRows;
    problem.terms.front().own_rows.push_back({{first, count}, {kBlocks * kRows + j, 1}});
  }
  jobs_done = 0;
  const Eigen::MatrixXd together = differentiate(problem, problem.start, {term.own}).jacobians.front();
  EXPECT_EQ(jobs_done, 1U + 2U * 2U);
  EXPECT_EQ(together, one_by_one);
}

TEST(BatchedLeastSquares, TheCovarianceIsThatOfTheWayAtLargeWhereResidualsJump) {
  // Slope 10 between jumps, slope 1 at large: the standard error is 1, the inverse information says 0.1.
  BatchedProblem problem;
  problem.start = VectorXd::Zero(1);
  problem.lower = VectorXd::Constant(1, -10.0);
  problem.upper = VectorXd::Constant(1, 10.0);
  problem.step = VectorXd::Constant(1, 1e-3);
  problem.terms.push_back({1, {}, {}});
  problem.evaluate = [](const std::vector<BatchedProblem::Job>& jobs) {
    std::vector<VectorXd> residuals;
    for (const BatchedProblem::Job& job : jobs) {
      const double between = 0.02 * std::round(job.shared[0] / 0.02);
      residuals.emplace_back(VectorXd::Constant(1, between + 10.0 * (job.shared[0] - between)));
    }
    return residuals;
  };
  const BatchedDerivatives at = differentiate(problem, problem.start, {VectorXd()});
  EXPECT_NEAR(shared_information(at, 1)(0, 0), 100.0, 1e-6);
  EXPECT_NEAR(std::sqrt(squares_covariance(problem, at)(0, 0)), 1.0, 0.1);
}

TEST(BatchedLeastSquares, TheCovarianceOfASearchThatEndedInALocalMinimumIsLargerByItsExcess) {
  BatchedProblem problem;
  problem.start = VectorXd::Zero(1);
  problem.lower = VectorXd::Constant(1, -1e3);
  problem.upper = VectorXd::Constant(1, 1e3);
  problem.step = VectorXd::Constant(1, 1.0);
  problem.terms.push_back({1, {}, {}});
  double jump = 0.0;  // of the sum of squares, before two deviations
  problem.evaluate = [&](const std::vector<BatchedProblem::Job>& jobs) {
    std::vector<VectorXd> residuals;
    for (const BatchedProblem::Job& job : jobs) {
      const double x = job.shared[0];
      residuals.emplace_back(VectorXd::Constant(1, std::abs(x) < 1.5 ? x : std::copysign(std::sqrt(x * x + jump), x)));
    }
    return residuals;
  };
  const BatchedDerivatives at = differentiate(problem, problem.start, {VectorXd()});
  EXPECT_NEAR(squares_covariance(problem, at, 24.0)(0, 0), 1.0, 1e-9);  // smooth: nothing is near that is better
  jump =
      3.0;  // a point as good is anywhere within sqrt(3) deviations: a uniform distribution has a third of that square
  const double wander = jump / 3.0;
  EXPECT_NEAR(squares_covariance(problem, at)(0, 0), 1.0 + wander, 1e-9);
  EXPECT_NEAR(squares_covariance(problem, at, 24.0)(0, 0), 1.0 + wander + 24.0, 1e-9);
  EXPECT_NEAR(squares_covariance(problem, at, -5.0)(0, 0), 1.0 + wander, 1e-9);
}

}  // namespace
}  // namespace snug::numerics
