// Products and decompositions of matrices of any size: compiled once for all who need them.
#pragma once

#include <Eigen/Core>

namespace snug::numerics {

[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// A^T B
[[nodiscard]] Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// A M A^T
[[nodiscard]] Eigen::MatrixXd congruence(const Eigen::MatrixXd& A, const Eigen::MatrixXd& M);
/// D M D, where D has d on its diagonal.
[[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& M, const Eigen::VectorXd& d);

/// X of A X = B by LDL^T, where A, n x n, is symmetric and positive or negative semidefinite. B: n x m.
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// Inverse of A, n x n, symmetric and positive definite, by LDL^T.
[[nodiscard]] Eigen::MatrixXd invert_symmetric(const Eigen::MatrixXd& A);
/// By LU with partial pivoting.
[[nodiscard]] Eigen::MatrixXd invert(const Eigen::MatrixXd& A);
/// X that makes |A X - B| least, by QR with column pivoting. A: n x k of full rank, n >= k; B: n x m.
[[nodiscard]] Eigen::MatrixXd solve_by_qr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// R, k x k, of A = Q R. A: n x k, n >= k. Sums of squares of A's columns and their products are those of R's.
[[nodiscard]] Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& A);

/// Values ascend; vectors are columns.
struct Eigenpairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// Of A, symmetric: its lower half is read. Vectors have length one.
[[nodiscard]] Eigenpairs symmetric_eigenpairs(const Eigen::MatrixXd& A);
/// A v = value B v of symmetric A and positive definite B; V^T B V = 1.
[[nodiscard]] Eigenpairs generalized_eigenpairs(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace snug::numerics
