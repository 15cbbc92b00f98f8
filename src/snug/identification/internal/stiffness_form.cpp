// StiffnessForm as numbers.
#include "snug/identification/internal/stiffness_form.hpp"

#include <cmath>

#include "snug/cup/law.hpp"

namespace snug::identification::internal {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};

const char* unit_of(int row, int column) {
  if (column < 3) return "N/m";
  return row < 3 ? "N/rad" : "Nm/rad";
}

Form make_symmetric() {
  Form form;
  const auto add = [&](int row, int column, const model::CupElasticity& one, const char* name) {
    form.numbers.push_back({row, column, cup::as_matrix(one), name, unit_of(row, column)});
  };
  add(0, 0, {.lateral = 1.0}, "k_lat");
  add(2, 2, {.axial = 1.0}, "k_ax");
  add(3, 3, {.bend = 1.0}, "k_bend");
  add(5, 5, {.torsion = 1.0}, "k_tors");
  add(0, 4, {.coupling = 1.0}, "c");
  return form;
}

Form make_full() {
  Form form;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      Matrix6 basis = Matrix6::Zero();
      basis(row, column) = basis(column, row) = 1.0;
      form.numbers.push_back(
          {row, column, basis, std::string("k_") + kAxes[row] + "_" + kAxes[column], unit_of(row, column)});
    }
  }
  return form;
}

/// Place of an entry in the upper triangle, row by row.
Eigen::Index place(int row, int column) { return row * 6 - row * (row - 1) / 2 + column - row; }

SymmetryConditions make_conditions() {
  SymmetryConditions conditions;
  conditions.rows = Eigen::MatrixXd::Zero(16, 21);
  const auto name = [](int row, int column) { return std::string("k_") + kAxes[row] + "_" + kAxes[column]; };
  const auto add = [&](int row, int column, int other_row, int other_column, double sign) {
    const auto i = static_cast<Eigen::Index>(conditions.names.size());
    conditions.rows(i, place(row, column)) = 1.0;
    std::string text = name(row, column);
    if (sign != 0.0) {
      conditions.rows(i, place(other_row, other_column)) = sign;
      text += (sign < 0.0 ? " - " : " + ") + name(other_row, other_column);
    }
    conditions.names.push_back(text);
  };
  add(0, 0, 1, 1, -1.0);
  add(3, 3, 4, 4, -1.0);
  add(0, 4, 1, 3, 1.0);
  for (int row = 0; row < 6; ++row) {
    for (int column = row + 1; column < 6; ++column)
      if (!(row == 0 && column == 4) && !(row == 1 && column == 3)) add(row, column, 0, 0, 0.0);
  }
  return conditions;
}

}  // namespace

Matrix6 Form::matrix(const Eigen::VectorXd& theta) const {
  Matrix6 sum = Matrix6::Zero();
  for (Eigen::Index i = 0; i < size(); ++i) sum += theta[i] * numbers[static_cast<std::size_t>(i)].basis;
  return sum;
}

Eigen::VectorXd Form::numbers_of(const Matrix6& matrix) const {
  Eigen::VectorXd theta(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Number& number = numbers[static_cast<std::size_t>(i)];
    theta[i] = matrix(number.row, number.column);
  }
  return theta;
}

Eigen::VectorXd Form::scale_in(const Matrix6& matrix) const {
  Eigen::VectorXd scale(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Number& number = numbers[static_cast<std::size_t>(i)];
    scale[i] = std::sqrt(std::abs(matrix(number.row, number.row) * matrix(number.column, number.column)));
  }
  return scale;
}

Eigen::MatrixXd Form::inverse_jacobian(const Matrix6& inverse) const {
  Eigen::MatrixXd J(size(), size());
  for (Eigen::Index i = 0; i < size(); ++i)  // d(M^-1) = -M^-1 dM M^-1
    J.col(i) = numbers_of(-(inverse * numbers[static_cast<std::size_t>(i)].basis * inverse));
  return J;
}

const Form& form_of(StiffnessForm form) {
  static const Form symmetric = make_symmetric(), full = make_full();
  return form == StiffnessForm::Symmetric ? symmetric : full;
}

model::CupElasticity nearest_elasticity(const Matrix6& K) {
  return {.lateral = 0.5 * (K(0, 0) + K(1, 1)),
          .axial = K(2, 2),
          .bend = 0.5 * (K(3, 3) + K(4, 4)),
          .torsion = K(5, 5),
          .coupling = 0.5 * (K(0, 4) - K(1, 3))};
}

const SymmetryConditions& symmetry_conditions() {
  static const SymmetryConditions conditions = make_conditions();
  return conditions;
}

}  // namespace snug::identification::internal
