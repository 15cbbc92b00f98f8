// symmetric_eigenvalues: of 6 x 6 matrices. Eigen's solver, unrolled for six, takes a quarter of a minute to compile.
#include "snug/spatial/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace snug {

Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(M, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace snug
