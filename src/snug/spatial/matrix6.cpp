// Linear algebra of 6 x 6 matrices and of rotations: Eigen's eigenvalues alone, unrolled for six, take a quarter of a
// minute to compile.
#include "snug/spatial/matrix6.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace snug {

Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(M, Eigen::EigenvaluesOnly).eigenvalues();
}

double spectral_radius(const Matrix6& M) noexcept { return M.eigenvalues().cwiseAbs().maxCoeff(); }

bool is_positive_definite(const Matrix6& M) noexcept { return Eigen::LLT<Matrix6>(M).info() == Eigen::Success; }

Matrix6 inverse(const Matrix6& M) noexcept { return M.inverse(); }

Vector6 solve(const Matrix6& M, const Vector6& b) noexcept { return M.partialPivLu().solve(b); }

Quaternion rotation_between(const Vector3& from, const Vector3& to) noexcept {
  return Quaternion::FromTwoVectors(from, to);
}

}  // namespace snug
