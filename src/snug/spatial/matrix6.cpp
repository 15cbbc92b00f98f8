// Linear algebra of small matrices and of rotations: Eigen's eigenvalues alone, unrolled for six, take a quarter of a
// minute to compile.
#include "snug/spatial/matrix6.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace snug {

Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(M, Eigen::EigenvaluesOnly).eigenvalues();
}

Matrix6 cholesky(const Matrix6& M) noexcept { return Eigen::LLT<Matrix6>(M).matrixL(); }

double spectral_radius(const Matrix6& A, const Matrix6& B) noexcept {
  const Matrix6 C = inverse(cholesky(B));
  return symmetric_eigenvalues(C * A.selfadjointView<Eigen::Lower>() * C.transpose()).cwiseAbs().maxCoeff();
}

bool is_positive_definite(const Matrix6& M) noexcept { return Eigen::LLT<Matrix6>(M).info() == Eigen::Success; }

Matrix6 inverse(const Matrix6& M) noexcept { return M.inverse(); }

Vector6 solve(const Matrix6& M, const Vector6& b) noexcept { return M.partialPivLu().solve(b); }

Vector6 solve_symmetric(const Matrix6& M, const Vector6& b) noexcept { return M.ldlt().solve(b); }

Eigenpairs3 symmetric_eigenpairs(const Matrix3& M) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(M);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Quaternion rotation_between(const Vector3& from, const Vector3& to) noexcept {
  const Vector3 a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  // Where they are (almost) opposite their cross product tells no axis.
  if (cosine < -1.0 + 1e-12) return Quaternion(Eigen::AngleAxisd(std::numbers::pi, a.unitOrthogonal()));
  const double s = std::sqrt(2.0 * (1.0 + cosine));
  Quaternion q;
  q.vec() = a.cross(b) * (1.0 / s);
  q.w() = 0.5 * s;
  return q;
}

}  // namespace snug
