// Linear algebra of 3 x 3 and 6 x 6 matrices and of rotations whose templates are large: compiled once for all who need
// it.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug {

/// Ascending; of M, symmetric, the lower half is read.
[[nodiscard]] Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept;
/// Largest |lambda| of A x = lambda B x; A symmetric, B symmetric and positive definite: their lower halves are read.
[[nodiscard]] double spectral_radius(const Matrix6& A, const Matrix6& B) noexcept;
/// L, lower triangular, of M = L L^T, symmetric and positive definite: its lower half is read.
[[nodiscard]] Matrix6 cholesky(const Matrix6& M) noexcept;
/// Of M, symmetric: its lower half is read.
[[nodiscard]] bool is_positive_definite(const Matrix6& M) noexcept;
/// By LU with partial pivoting; of a singular matrix numbers that are not finite.
[[nodiscard]] Matrix6 inverse(const Matrix6& M) noexcept;
/// Of the upper triangle of U, the same at any processor.
[[nodiscard]] Matrix6 upper_inverse(const Matrix6& U) noexcept;
/// x of M x = b, as `inverse`.
[[nodiscard]] Vector6 solve(const Matrix6& M, const Vector6& b) noexcept;
/// x of M x = b by LDL^T, of M, symmetric and semidefinite: its lower half is read.
[[nodiscard]] Vector6 solve_symmetric(const Matrix6& M, const Vector6& b) noexcept;

/// Values ascend; vectors are columns of length one.
struct Eigenpairs3 {
  Vector3 values;
  Matrix3 vectors;
};
/// Of M, symmetric: its lower half is read.
[[nodiscard]] Eigenpairs3 symmetric_eigenpairs(const Matrix3& M) noexcept;

/// The smallest rotation that turns the direction of `from` to that of `to`; any of them where they are opposite.
[[nodiscard]] Quaternion rotation_between(const Vector3& from, const Vector3& to) noexcept;

}  // namespace snug
