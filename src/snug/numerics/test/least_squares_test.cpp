// Tests of the least-squares wrapper: shared and own unknowns, what eliminates them, and losses.
#include "snug/numerics/least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/numerics/outliers.hpp"

namespace snug::numerics {
namespace {

/// y = slope x + offset of this line: the slope is shared, each term owns its offset.
std::vector<LeastSquaresTerm> make_lines(int lines, int points, double slope, double noise) {
  Rng rng = Rng(3).split("lines");
  std::vector<LeastSquaresTerm> terms;
  for (int line = 0; line < lines; ++line) {
    Eigen::VectorXd x(points), y(points);
    for (int i = 0; i < points; ++i) {
      x[i] = rng.uniform(-1.0, 1.0);
      y[i] = slope * x[i] + 0.7 * line + noise * rng.normal();
    }
    terms.push_back(
        {points, Eigen::VectorXd::Zero(1),
         [x, y](const Eigen::VectorXd& shared, const Eigen::VectorXd& own, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
           r = (shared[0] * x).array() + own[0] - y.array();
           if (J == nullptr) return;
           J->col(0) = x;
           J->col(1).setOnes();
         }});
  }
  return terms;
}

TEST(LeastSquares, FindsSharedAndOwnUnknownsOfExactData) {
  const LeastSquaresResult found = solve_least_squares(make_lines(3, 7, -2.5, 0.0), Eigen::VectorXd::Zero(1));
  ASSERT_TRUE(found.has_converged) << found.message;
  EXPECT_NEAR(found.x[0], -2.5, 1e-10);  // tolerances of the solver: 1e-14 of the cost
  for (int line = 0; line < 3; ++line) EXPECT_NEAR(found.own[static_cast<std::size_t>(line)][0], 0.7 * line, 1e-10);
  EXPECT_LT(found.cost, 1e-18);
}

TEST(LeastSquares, InformationIsThatOfTheSlopeWithEveryOffsetUnknown) {
  const std::vector<LeastSquaresTerm> terms = make_lines(4, 9, 1.0, 0.1);
  const LeastSquaresResult found = solve_least_squares(terms, Eigen::VectorXd::Zero(1));
  // Closed form: the sum over the lines of the squared deviations of x from the line's mean.
  double expected = 0.0;
  for (const LeastSquaresTerm& term : terms) {
    Eigen::VectorXd r(9);
    Eigen::MatrixXd J(9, 2);
    term.evaluate(found.x, term.own, r, &J);
    expected += (J.col(0).array() - J.col(0).mean()).square().sum();
  }
  EXPECT_NEAR(found.information(0, 0), expected, 1e-12 * expected);
}

TEST(LeastSquares, IsTheSameTwice) {
  const LeastSquaresResult one = solve_least_squares(make_lines(5, 11, 0.3, 0.2), Eigen::VectorXd::Zero(1));
  const LeastSquaresResult two = solve_least_squares(make_lines(5, 11, 0.3, 0.2), Eigen::VectorXd::Zero(1));
  EXPECT_EQ(one.x[0], two.x[0]);
  EXPECT_EQ(one.information(0, 0), two.information(0, 0));
}

TEST(LeastSquares, SaysWhenItIsGivenAFunctionWithoutMinimum) {
  LeastSquaresTerm term{
      1, {}, [](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
        r[0] = std::nan("");
        if (J != nullptr) (*J)(0, 0) = x[0];
      }};
  EXPECT_FALSE(solve_least_squares({term}, Eigen::VectorXd::Ones(1)).has_converged);
}

TEST(Outliers, AreFoundAmongHalfAsManyAndNoiseIsNone) {
  Rng rng = Rng(5).split("outliers");
  std::vector<double> sizes;
  for (int i = 0; i < 500; ++i) {
    double sum = 0.0;
    for (int k = 0; k < 6; ++k) sum += std::pow(0.2 * rng.normal(), 2);
    sizes.push_back(std::sqrt(sum));
  }
  EXPECT_NEAR(median_deviation(sizes, 6), 0.2, 0.01);  // 500 norms: 2 % standard deviation of the median
  EXPECT_TRUE(find_outliers(sizes, 6, 0.0).empty());
  sizes[17] = 3.0;
  EXPECT_EQ(find_outliers(sizes, 6, 0.0), std::vector<std::size_t>{17});
}

TEST(Outliers, OfAFitToFewNumbersAreFartherOff) {
  // Deviation 1 by the median; 18 unknowns of 12 sizes of six numbers: 6 (1 + 5 / (12 - 3)) = 9.33.
  std::vector<double> sizes(12, 2.3126);
  sizes[4] = 9.2;
  EXPECT_EQ(find_outliers(sizes, 6, 0.0), std::vector<std::size_t>{4});
  EXPECT_TRUE(find_outliers(sizes, 6, 0.0, 18).empty());
  sizes[4] = 9.4;
  EXPECT_EQ(find_outliers(sizes, 6, 0.0, 18), std::vector<std::size_t>{4});
}

}  // namespace
}  // namespace snug::numerics
