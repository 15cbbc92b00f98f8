// QpSolver: optimality on random problems, degenerate and impossible ones, and what is not a number.
#include "snug/numerics/qp.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "snug/core/rng.hpp"

namespace snug::numerics {
namespace {

constexpr double kNoBound = -std::numeric_limits<double>::infinity();

QpVector random_vector(Rng& rng, int n, double size = 1.0) {
  QpVector v(n);
  for (double& entry : v) entry = size * rng.uniform(-1.0, 1.0);
  return v;
}

QpMatrix random_hessian(Rng& rng, int n, double smallest) {
  QpMatrix B(n, n);
  for (Eigen::Index i = 0; i < n; ++i) B.col(i) = random_vector(rng, n);
  return B * B.transpose() + smallest * QpMatrix::Identity(n, n);
}

/// Rows that the point `inside` fulfils, some of them with equality.
QpProblem random_problem(Rng& rng, int n, int m, double smallest) {
  QpProblem problem;
  problem.reset(n);
  problem.H = random_hessian(rng, n, smallest);
  problem.g = random_vector(rng, n, 10.0);
  const QpVector inside = random_vector(rng, n);
  for (int i = 0; i < m; ++i) {
    const QpVector a = random_vector(rng, n, std::pow(10.0, rng.uniform(-2.0, 2.0)));
    problem.add_row(a.transpose(), a.dot(inside) - (rng.uniform() < 0.3 ? 0.0 : a.norm() * rng.uniform()));
  }
  return problem;
}

double cost(const QpProblem& problem, const QpVector& x) { return 0.5 * x.dot(problem.H * x) + problem.g.dot(x); }

/// Smallest cost over all points where some subset of rows holds with equality: the slow, obvious way.
double brute_force(const QpProblem& problem) {
  const int n = static_cast<int>(problem.g.size()), m = problem.row_count();
  double best = std::numeric_limits<double>::infinity();
  for (int mask = 0; mask < (1 << m); ++mask) {
    const int k = __builtin_popcount(static_cast<unsigned>(mask));
    if (k > n) continue;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + k, n + k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + k);
    K.topLeftCorner(n, n) = problem.H;
    right.head(n) = -problem.g;
    for (int i = 0, j = 0; i < m; ++i) {
      if ((mask >> i & 1) == 0) continue;
      K.block(n + j, 0, 1, n) = problem.A.row(i);
      K.block(0, n + j, n, 1) = -problem.A.row(i).transpose();
      right[n + j++] = problem.b[i];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(K);
    if (factor.rank() < n + k) continue;
    const QpVector x = factor.solve(right).head(n);
    if ((problem.A * x - problem.b).minCoeff() > -1e-9) best = std::min(best, cost(problem, x));
  }
  return best;
}

TEST(QpSolver, FulfilsTheOptimalityConditionsOnRandomProblems) {
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(1).split("random");
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const int n = 1 + rng.index(7), m = rng.index(60);
    const QpProblem problem = random_problem(rng, n, m, 1e-3);
    solver.solve(problem, result);
    ASSERT_EQ(result.status, QpStatus::Solved);
    EXPECT_LT(result.residual, 1e-8);  // condition up to 1e5 times rounding times the size of g
    if (m > 0) {
      EXPECT_GE(result.multipliers.minCoeff(), 0.0);
    }
  }
}

TEST(QpSolver, FindsTheSmallestCostOfAllSetsOfActiveRows) {
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(2).split("brute force");
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const QpProblem problem = random_problem(rng, 3, 8, 0.1);
    solver.solve(problem, result);
    ASSERT_EQ(result.status, QpStatus::Solved);
    const double best = brute_force(problem);
    EXPECT_NEAR(cost(problem, result.x), best, 1e-8 * (1.0 + std::abs(best)));
  }
}

TEST(QpSolver, ProjectsOnABoxExactly) {  // closed form: clamp
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(6);
  problem.H.setIdentity();
  for (int j = 0; j < 6; ++j) problem.g[j] = -2.0 * (j - 2.5);
  for (int j = 0; j < 6; ++j) {
    problem.add_row(QpVector::Unit(6, j).transpose(), -1.0);
    problem.add_row(-QpVector::Unit(6, j).transpose(), -2.0);
  }
  solver.solve(problem, result);
  ASSERT_EQ(result.status, QpStatus::Solved);
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(result.x[j], std::clamp(2.0 * (j - 2.5), -1.0, 2.0), 1e-13);
}

TEST(QpSolver, TakesRowsThatRepeatAndDependOnEachOther) {
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(3).split("degenerate");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    QpProblem problem = random_problem(rng, 6, 12, 1e-3);
    for (int j = 0; j < 12; ++j) problem.add_row(problem.A.row(j).eval(), problem.b[j]);  // twice
    for (int j = 0; j < 11; ++j) {                                                        // and sums
      problem.add_row((problem.A.row(j) + problem.A.row(j + 1)).eval(), problem.b[j] + problem.b[j + 1]);
    }
    solver.solve(problem, result);
    ASSERT_EQ(result.status, QpStatus::Solved);
    EXPECT_LT(result.residual, 1e-8);
  }
}

TEST(QpSolver, HoldsOpposedRowsThatLeaveOnePoint) {
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(2);
  problem.H.setIdentity();
  problem.g << -3.0, 4.0;
  for (const double sign : {1.0, -1.0}) {
    problem.add_row((sign * QpVector::Unit(2, 0)).transpose(), sign * 0.5);
    problem.add_row((sign * QpVector::Unit(2, 1)).transpose(), sign * -0.25);
  }
  solver.solve(problem, result);
  ASSERT_EQ(result.status, QpStatus::Solved);
  EXPECT_NEAR(result.x[0], 0.5, 1e-12);
  EXPECT_NEAR(result.x[1], -0.25, 1e-12);
}

TEST(QpSolver, SaysWhichRowsContradictAndByHowMuch) {
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(2);
  problem.H.setIdentity();
  problem.add_row(QpVector::Unit(2, 1).transpose(), -5.0);
  problem.add_row((2.0 * QpVector::Unit(2, 0)).transpose(), 4.0);  // x0 >= 2
  problem.add_row(-QpVector::Unit(2, 0).transpose(), -1.0);        // x0 <= 1
  solver.solve(problem, result);
  ASSERT_EQ(result.status, QpStatus::Infeasible);
  EXPECT_NEAR(result.x[0], 1.5, 1e-9);  // the search stops when it gains less than 1e-11
  EXPECT_TRUE(result.worst_row == 1 || result.worst_row == 2);
  EXPECT_NEAR(result.violation, result.worst_row == 1 ? 1.0 : 0.5, 1e-9);
  EXPECT_EQ(result.multipliers[0], 0.0);
  EXPECT_GT(result.multipliers[1], 0.0);
  EXPECT_GT(result.multipliers[2], 0.0);
}

TEST(QpSolver, FindsPlantedContradictionsOfAnySize) {
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(4).split("infeasible");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    QpProblem problem = random_problem(rng, 6, 20, 1e-3);
    const double size = std::pow(10.0, rng.uniform(-4.0, 3.0));
    const QpVector a = random_vector(rng, 6).normalized();
    const double middle = rng.uniform(-1.0, 1.0);
    problem.add_row(a.transpose(), middle + size);
    problem.add_row(-a.transpose(), -middle + size);
    solver.solve(problem, result);
    ASSERT_EQ(result.status, QpStatus::Infeasible);
    // The two rows alone cannot be violated by less than `size`; together with others it may be more.
    EXPECT_GT((problem.b - problem.A * result.x).maxCoeff(), size * (1.0 - 1e-4));
    EXPECT_GT(result.violation, 0.0);
    EXPECT_GE(result.worst_row, 0);
  }
}

TEST(QpSolver, RefusesWhatIsNotANumber) {
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(5).split("nan");
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int part = 0; part < 4; ++part) {
      QpProblem problem = random_problem(rng, 6, 10, 1e-3);
      if (part == 0) problem.H(2, 3) = bad;
      if (part == 1) problem.g[4] = bad;
      if (part == 2) problem.A(7, 1) = bad;
      if (part == 3) problem.b[3] = bad;
      solver.solve(problem, result);
      EXPECT_EQ(result.status, QpStatus::NotFinite);
      EXPECT_TRUE(result.x.isZero(0.0));
    }
  }
}

TEST(QpSolver, SkipsRowsWithoutABound) {
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(1);
  problem.H(0, 0) = 1.0;
  problem.g[0] = 1.0;
  problem.add_row(QpVector::Unit(1, 0).transpose(), kNoBound);
  solver.solve(problem, result);
  ASSERT_EQ(result.status, QpStatus::Solved);
  EXPECT_DOUBLE_EQ(result.x[0], -1.0);
}

TEST(QpSolver, RefusesAHessianThatIsNotPositiveDefinite) {
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(3);
  solver.solve(problem, result);
  EXPECT_EQ(result.status, QpStatus::NotConvex);
  problem.H.setIdentity();
  problem.H(1, 1) = -1.0;
  solver.solve(problem, result);
  EXPECT_EQ(result.status, QpStatus::NotConvex);
}

TEST(QpSolver, FindsTheEmptyRowThatNothingFulfils) {
  QpSolver solver;
  QpResult result;
  QpProblem problem;
  problem.reset(2);
  problem.H.setIdentity();
  problem.add_row(QpVector::Zero(2).transpose(), -1.0);
  solver.solve(problem, result);
  EXPECT_EQ(result.status, QpStatus::Solved);
  problem.add_row(QpVector::Zero(2).transpose(), 0.5);
  solver.solve(problem, result);
  ASSERT_EQ(result.status, QpStatus::Infeasible);
  EXPECT_EQ(result.worst_row, 1);
  EXPECT_EQ(result.violation, 0.5);
}

TEST(QpSolver, GivesTheSameBytesWhateverWasSolvedBefore) {
  Rng rng = Rng(6).split("history");
  QpSolver used;
  QpResult first, second;
  for (int i = 0; i < 200; ++i) {
    const QpProblem problem = random_problem(rng, 6, 30, 1e-3);
    QpSolver fresh;
    used.solve(problem, first);
    fresh.solve(problem, second);
    ASSERT_EQ(first.x, second.x);
    ASSERT_EQ(first.multipliers, second.multipliers);
  }
}

TEST(QpSolver,
     TakesHessiansOfTasksWithVeryDifferentWeights) {  // 5e6 for the tool, 1 for the posture, near a singularity
  QpSolver solver;
  QpResult result;
  Rng rng = Rng(7).split("weights");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    QpProblem problem = random_problem(rng, 6, 24, 1e-3);
    QpMatrix J = random_hessian(rng, 6, 0.0);
    J.row(5) = J.row(4) * (1.0 + 1e-6);
    problem.H = 5e6 * J.transpose() * J + QpMatrix::Identity(6, 6);
    problem.g *= 1e6;
    solver.solve(problem, result);
    ASSERT_EQ(result.status, QpStatus::Solved);
    EXPECT_LT(result.residual, 1e-6);
  }
}

}  // namespace
}  // namespace snug::numerics
