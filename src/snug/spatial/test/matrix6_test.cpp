// Small matrices and rotations against their definitions, singular and opposite cases among them.
#include "snug/spatial/matrix6.hpp"

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"

namespace snug {
namespace {

Matrix6 random_matrix(Rng& rng) {
  return Matrix6::NullaryExpr([&] { return rng.normal(); });
}

TEST(Matrix6, InversesAndSolutionsAreWhatTheySay) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const Matrix6 M = random_matrix(rng) + 3.0 * Matrix6::Identity();
    const Vector6 b = Vector6::NullaryExpr([&] { return rng.normal(); });
    const double size = inverse(M).norm() * M.norm();
    EXPECT_LT((M * inverse(M) - Matrix6::Identity()).norm(), 1e-13 * size);
    const Matrix6 U = M.triangularView<Eigen::Upper>();
    EXPECT_LT((U * upper_inverse(M) - Matrix6::Identity()).norm(), 1e-13 * upper_inverse(M).norm() * U.norm());
    EXPECT_LT((M * solve(M, b) - b).norm(), 1e-13 * size);
    const Matrix6 S = M * M.transpose();
    EXPECT_LT((S * solve_symmetric(S, b) - b).norm(), 1e-13 * size * size);
  }
  EXPECT_FALSE(inverse(Matrix6::Zero()).allFinite());
}

TEST(Matrix3, EigenpairsAscendAndAreWhatTheySay) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const Matrix3 half = Matrix3::NullaryExpr([&] { return rng.normal(); }), M = half + half.transpose();
    const Eigenpairs3 found = symmetric_eigenpairs(M);
    EXPECT_LT((M * found.vectors - found.vectors * found.values.asDiagonal()).norm(), 1e-13 * M.norm());
    EXPECT_LT((found.vectors.transpose() * found.vectors - Matrix3::Identity()).norm(), 1e-13);
    EXPECT_TRUE(found.values[0] <= found.values[1] && found.values[1] <= found.values[2]);
  }
}

TEST(Matrix6, KnowsWhatIsPositiveDefinite) {
  EXPECT_TRUE(is_positive_definite(Matrix6::Identity()));
  EXPECT_FALSE(is_positive_definite(Matrix6::Zero()));
  Matrix6 M = Matrix6::Identity();
  M(3, 3) = -1e-9;
  EXPECT_FALSE(is_positive_definite(M));
}

TEST(Matrix6, TheSpectralRadiusOfAPairIsThatOfItsLargestEigenvalueAlsoWhereItIsNegative) {
  Rng rng(7);
  for (int trial = 0; trial < 20; ++trial) {
    Matrix6 V;
    for (double& v : V.reshaped()) v = rng.normal();
    Vector6 lambda;
    for (double& l : lambda) l = rng.normal();
    // With B = V^T V and A = V^T diag(lambda) V the pair's eigenvalues are lambda.
    const Matrix6 B = V.transpose() * V, A = V.transpose() * lambda.asDiagonal() * V;
    EXPECT_NEAR(spectral_radius(A, B), lambda.cwiseAbs().maxCoeff(), 1e-12 * inverse(B).norm() * A.norm());
  }
}

TEST(RotationBetween, TurnsOneDirectionToTheOtherByTheSmallestAngle) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const Vector3 a(rng.normal(), rng.normal(), rng.normal()), b(rng.normal(), rng.normal(), rng.normal());
    const Quaternion q = rotation_between(a, b);
    EXPECT_LT((q * a.normalized() - b.normalized()).norm(), 1e-12);
    EXPECT_NEAR(2.0 * std::acos(std::min(1.0, std::abs(q.w()))), std::acos(a.normalized().dot(b.normalized())), 1e-6);
  }
  const Vector3 up = Vector3::UnitZ();
  EXPECT_LT((rotation_between(up, -up) * up + up).norm(), 1e-12) << "opposite: half a turn about any axis";
}

}  // namespace
}  // namespace snug
