// Decompositions against what they promise: A X = B, orthogonal vectors, least residuals; singular and tall matrices.
#include "snug/numerics/dense.hpp"

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"

namespace snug::numerics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, Rng& rng) {
  return MatrixXd::NullaryExpr(rows, columns, [&] { return rng.normal(); });
}

MatrixXd definite(Eigen::Index n, Rng& rng) {
  const MatrixXd A = random_matrix(n, n, rng);
  return A * A.transpose() + MatrixXd::Identity(n, n);
}

TEST(Dense, SolvesAndInvertsSymmetricMatrices) {
  Rng rng(1);
  for (const Eigen::Index n : {1, 2, 6, 21, 60}) {
    const MatrixXd A = definite(n, rng), B = random_matrix(n, 3, rng);
    EXPECT_LT((A * solve_symmetric(A, B) - B).norm(), 1e-9 * B.norm()) << n;
    EXPECT_LT((A * invert_symmetric(A) - MatrixXd::Identity(n, n)).norm(), 1e-9) << n;
    EXPECT_LT((invert(A) - invert_symmetric(A)).norm(), 1e-9 * invert(A).norm()) << n;
    const VectorXd d = random_matrix(n, 1, rng);
    EXPECT_LT((scaled(A, d) - d.asDiagonal() * A * d.asDiagonal()).norm(), 1e-12 * A.norm()) << n;
    EXPECT_LT((congruence(B.transpose(), A) - B.transpose() * A * B).norm(), 1e-12 * B.squaredNorm() * A.norm()) << n;
    EXPECT_LT((-A * solve_symmetric(-A, B) - B).norm(), 1e-9 * B.norm()) << "negative definite, " << n;
  }
}

TEST(Dense, LeastSquaresLeaveAResidualThatIsNormalToTheColumns) {
  Rng rng(2);
  const MatrixXd A = random_matrix(40, 6, rng), B = random_matrix(40, 2, rng);
  const MatrixXd residual = A * solve_by_qr(A, B) - B;
  EXPECT_LT((A.transpose() * residual).norm(), 1e-10);
  EXPECT_GT(residual.norm(), 1.0);
}

TEST(Dense, EigenpairsAscendAndAreWhatTheySay) {
  Rng rng(4);
  const MatrixXd A = definite(12, rng), B = definite(12, rng);
  const Eigenpairs plain = symmetric_eigenpairs(A), general = generalized_eigenpairs(A, B);
  EXPECT_LT((A * plain.vectors - plain.vectors * plain.values.asDiagonal()).norm(), 1e-9);
  EXPECT_LT((plain.vectors.transpose() * plain.vectors - MatrixXd::Identity(12, 12)).norm(), 1e-12);
  EXPECT_LT((A * general.vectors - B * general.vectors * general.values.asDiagonal()).norm(), 1e-8);
  EXPECT_LT((general.vectors.transpose() * B * general.vectors - MatrixXd::Identity(12, 12)).norm(), 1e-10);
  for (Eigen::Index i = 1; i < 12; ++i) {
    EXPECT_LE(plain.values[i - 1], plain.values[i]);
    EXPECT_LE(general.values[i - 1], general.values[i]);
  }
}

TEST(TriangularFactor, HasTheProductsOfTheColumns) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(40, 5);
  const Eigen::MatrixXd R = triangular_factor(A);
  ASSERT_EQ(R.rows(), 5);
  EXPECT_LT((R.transpose() * R - A.transpose() * A).norm(), 1e-13 * A.squaredNorm());
  EXPECT_EQ(R.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm(), 0.0);
}

}  // namespace
}  // namespace snug::numerics
