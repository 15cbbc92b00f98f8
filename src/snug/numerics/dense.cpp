// Products and decompositions of matrices of any size: each takes seconds to compile.
#include "snug/numerics/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace snug::numerics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd product(const MatrixXd& A, const MatrixXd& B) { return A * B; }

MatrixXd transposed_product(const MatrixXd& A, const MatrixXd& B) { return A.transpose() * B; }

MatrixXd congruence(const MatrixXd& A, const MatrixXd& M) { return product(A, product(M, A.transpose())); }

MatrixXd scaled(const MatrixXd& M, const VectorXd& d) { return M.cwiseProduct(product(d, d.transpose())); }

MatrixXd solve_symmetric(const MatrixXd& A, const MatrixXd& B) { return A.ldlt().solve(B); }

MatrixXd invert_symmetric(const MatrixXd& A) { return solve_symmetric(A, MatrixXd::Identity(A.rows(), A.cols())); }

MatrixXd invert(const MatrixXd& A) { return A.inverse(); }

MatrixXd solve_by_qr(const MatrixXd& A, const MatrixXd& B) { return A.colPivHouseholderQr().solve(B); }

MatrixXd triangular_factor(const MatrixXd& A) {
  const MatrixXd R = Eigen::HouseholderQR<MatrixXd>(A).matrixQR().topRows(A.cols());
  return R.triangularView<Eigen::Upper>();
}

Eigenpairs symmetric_eigenpairs(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigenpairs generalized_eigenpairs(const MatrixXd& A, const MatrixXd& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(A, B);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace snug::numerics
