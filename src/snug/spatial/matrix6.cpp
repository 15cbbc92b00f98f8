// Linear algebra of small matrices and of rotations: Eigen's eigenvalues alone, unrolled for six, take a quarter of a
// minute to compile.
#include "snug/spatial/matrix6.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace snug {
namespace {

constexpr int kPanel = 4;  // rows that are solved before what they bring to the others is summed

/// x <- x - (sum over k of T(row, k) x(k)), k from `first` to `end` - 1, for column j of X.
void subtract_known(const Matrix6& T, int row, int first, int end, int j, Matrix6& X) {
  double sum = 0.0;
  for (int k = first; k < end; ++k) sum += T(row, k) * X(k, j);
  X(row, j) -= sum;
}

/// X <- L^-1 X, L the lower triangle with ones on its diagonal. Eigen's order of sums depends on the vectors that the
/// processor has; here and below it is that of two doubles each.
void solve_unit_lower(const Matrix6& L, Matrix6& X) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < kPanel; ++k) {
      for (int i = k + 1; i < kPanel; ++i) X(i, j) -= X(k, j) * L(i, k);
    }
    for (int i = kPanel; i < 6; ++i) subtract_known(L, i, 0, kPanel, j, X);
    X(5, j) -= X(4, j) * L(5, 4);
  }
}

/// X <- U^-1 X, U the upper triangle.
void solve_upper(const Matrix6& U, Matrix6& X) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 5; k >= 6 - kPanel; --k) {
      X(k, j) *= 1.0 / U(k, k);
      for (int i = 6 - kPanel; i < k; ++i) X(i, j) -= X(k, j) * U(i, k);
    }
    for (int i = 0; i < 6 - kPanel; ++i) subtract_known(U, i, 6 - kPanel, 6, j, X);
    X(1, j) *= 1.0 / U(1, 1);
    X(0, j) -= X(1, j) * U(0, 1);
    X(0, j) *= 1.0 / U(0, 0);
  }
}

}  // namespace

Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(M, Eigen::EigenvaluesOnly).eigenvalues();
}

Matrix6 cholesky(const Matrix6& M) noexcept { return Eigen::LLT<Matrix6>(M).matrixL(); }

double spectral_radius(const Matrix6& A, const Matrix6& B) noexcept {
  const Matrix6 C = inverse(cholesky(B));
  return symmetric_eigenvalues(C * A.selfadjointView<Eigen::Lower>() * C.transpose()).cwiseAbs().maxCoeff();
}

bool is_positive_definite(const Matrix6& M) noexcept { return Eigen::LLT<Matrix6>(M).info() == Eigen::Success; }

Matrix6 inverse(const Matrix6& M) noexcept {
  const Eigen::PartialPivLU<Matrix6> lu(M);
  Matrix6 X = lu.permutationP() * Matrix6::Identity();
  solve_unit_lower(lu.matrixLU(), X);
  solve_upper(lu.matrixLU(), X);
  return X;
}

Matrix6 upper_inverse(const Matrix6& U) noexcept {
  Matrix6 X = Matrix6::Identity();
  solve_upper(U, X);
  return X;
}

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
