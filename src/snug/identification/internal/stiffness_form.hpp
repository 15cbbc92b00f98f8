// StiffnessForm as numbers: which symmetric matrices a form spans, how its numbers are called and what they are large
// against. The compliance, the inverse of the stiffness, has the same form.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/stiffness.hpp"

namespace snug::identification::internal {

struct Form {
  struct Number {
    int row = 0;  ///< entry of the matrix that the number is, row <= column
    int column = 0;
    Matrix6 basis = Matrix6::Zero();  ///< the matrix is the sum of numbers times these
    std::string name;
    std::string unit;
  };
  std::vector<Number> numbers;

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(numbers.size()); }
  [[nodiscard]] Matrix6 matrix(const Eigen::VectorXd& theta) const;
  /// Reads the entries off: exact for matrices of this form.
  [[nodiscard]] Eigen::VectorXd numbers_of(const Matrix6& matrix) const;
  /// sqrt(M_rr M_cc) of each number.
  [[nodiscard]] Eigen::VectorXd scale_in(const Matrix6& matrix) const;
  /// d numbers of inverse(M) / d numbers of M.
  [[nodiscard]] Eigen::MatrixXd inverse_jacobian(const Matrix6& inverse) const;
};

[[nodiscard]] const Form& form_of(StiffnessForm form);

/// The five numbers nearest to a symmetric matrix (least squares of its entries within each kind).
[[nodiscard]] model::CupElasticity nearest_elasticity(const Matrix6& K);

/// The 16 conditions of the symmetric form: `conditions` x (the 21 numbers) = 0.
struct SymmetryConditions {
  Eigen::MatrixXd rows;
  std::vector<std::string> names;
};
[[nodiscard]] const SymmetryConditions& symmetry_conditions();

}  // namespace snug::identification::internal
