// StiffnessForm as numbers: bases, Jacobians, and what "the same from all sides" means.
#include "snug/identification/internal/stiffness_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/internal/pose_misfit.hpp"
#include "snug/numerics/dense.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

constexpr model::CupElasticity kFormCup{2300.0, 5500.0, 5.5, 2.8, -20.0};

/// The stiffness of the same cup seen from axes that are turned by R.
Matrix6 seen_from(const Matrix3& R, const Matrix6& K) {
  Matrix6 T = Matrix6::Zero();
  T.topLeftCorner<3, 3>() = T.bottomRightCorner<3, 3>() = R.transpose();
  return T * K * T.transpose();
}

/// The same in the mirror of the plane with this normal: forces are mirrored, torques are mirrored and turned over.
Matrix6 mirrored(const Vector3& normal, const Matrix6& K) {
  const Matrix3 M = Matrix3::Identity() - 2.0 * normal * normal.transpose();
  Matrix6 T = Matrix6::Zero();
  T.topLeftCorner<3, 3>() = M;
  T.bottomRightCorner<3, 3>() = -M;
  return T * K * T.transpose();
}

Matrix6 any_stiffness(Rng& rng) {
  Matrix6 A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = rng.uniform(-1.0, 1.0);
  const Vector6 size = (Vector6() << 50.0, 50.0, 75.0, 2.3, 2.3, 1.7).finished();  // roots of the cup's diagonal
  return size.asDiagonal() * Matrix6(0.1 * (A + A.transpose()) + 2.0 * Matrix6::Identity()) * size.asDiagonal();
}

Eigen::VectorXd full_numbers(const Matrix6& K) { return form_of(StiffnessForm::Full).numbers_of(K); }

TEST(StiffnessForm, NumbersComeBackFromTheirMatrix) {
  Rng rng = Rng(2).split("form");
  for (const StiffnessForm which : {StiffnessForm::Symmetric, StiffnessForm::Full}) {
    const Form& form = form_of(which);
    EXPECT_EQ(form.size(), which == StiffnessForm::Symmetric ? 5 : 21);
    Eigen::VectorXd theta(form.size());
    for (double& number : theta) number = rng.uniform(-10.0, 10.0);
    const Matrix6 K = form.matrix(theta);
    EXPECT_EQ(K, Matrix6(K.transpose()));
    EXPECT_EQ(form.numbers_of(K), theta);
    std::set<std::string> names;
    for (const Form::Number& number : form.numbers) {
      names.insert(number.name);
      EXPECT_LE(number.row, number.column) << number.name;
      EXPECT_EQ(number.basis(number.row, number.column), 1.0) << number.name;
    }
    EXPECT_EQ(names.size(), form.numbers.size());
  }
}

TEST(StiffnessForm, OfFiveNumbersIsTheLawOfTheCup) {
  const Form& form = form_of(StiffnessForm::Symmetric);
  Eigen::VectorXd theta(5);
  theta << kFormCup.lateral, kFormCup.axial, kFormCup.bend, kFormCup.torsion, kFormCup.coupling;
  EXPECT_EQ(form.matrix(theta), cup::as_matrix(kFormCup));
  const char* units[] = {"N/m", "N/m", "Nm/rad", "Nm/rad", "N/rad"};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(form.numbers[i].unit, units[i]) << form.numbers[i].name;
}

TEST(StiffnessForm, UnitsOfTwentyOneNumbersAreThoseOfTheirRowAndColumn) {
  // Force of a row (0-2) by metres or radians of a column (3-5); torque of a row (3-5) by radians.
  for (const Form::Number& number : form_of(StiffnessForm::Full).numbers) {
    const std::string unit = number.column < 3 ? "N/m" : number.row < 3 ? "N/rad" : "Nm/rad";
    EXPECT_EQ(number.unit, unit) << number.name;
  }
}

TEST(StiffnessForm, JacobianOfTheInverseIsThatOfDifferences) {
  Rng rng = Rng(5).split("inverse");
  const Matrix6 full = any_stiffness(rng), symmetric = cup::as_matrix(kFormCup);
  for (const StiffnessForm which : {StiffnessForm::Symmetric, StiffnessForm::Full}) {
    const Form& form = form_of(which);
    const Matrix6 M = which == StiffnessForm::Full ? full : symmetric;
    const Eigen::VectorXd scale = form.scale_in(M), of_inverse = form.scale_in(inverse(M));
    const Eigen::MatrixXd J = form.inverse_jacobian(inverse(M));
    for (Eigen::Index i = 0; i < form.size(); ++i) {
      const Matrix6 step = 1e-5 * scale[i] * form.numbers[static_cast<std::size_t>(i)].basis;
      const Eigen::VectorXd numeric =
          (form.numbers_of(inverse(M + step)) - form.numbers_of(inverse(M - step))) / (2e-5 * scale[i]);
      // In units of each number: central differences, 1e-10 of a third derivative of some units.
      const Eigen::VectorXd off = (numeric - J.col(i)).cwiseQuotient(of_inverse) * scale[i];
      EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-7) << form.numbers[static_cast<std::size_t>(i)].name;
    }
  }
}

TEST(StiffnessForm, JacobianThereAndBackIsOne) {
  const Form& form = form_of(StiffnessForm::Symmetric);
  const Matrix6 K = cup::as_matrix(kFormCup), C = inverse(K);
  const Eigen::MatrixXd both = form.inverse_jacobian(K) * form.inverse_jacobian(C);
  const Eigen::VectorXd scale = form.scale_in(C);
  const Eigen::MatrixXd in_units = scale.cwiseInverse().asDiagonal() * both * scale.asDiagonal();
  EXPECT_LT((in_units - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-10);  // rounding times the condition, 2000, squared
}

TEST(StiffnessForm, ScaleOfANumberIsTheRootOfTheTwoOnTheDiagonal) {
  const Matrix6 K = cup::as_matrix(kFormCup);
  const Eigen::VectorXd scale = form_of(StiffnessForm::Symmetric).scale_in(K);
  EXPECT_EQ(scale[0], 2300.0);
  EXPECT_EQ(scale[3], 2.8);
  EXPECT_NEAR(scale[4], std::sqrt(2300.0 * 5.5), 1e-9);  // whatever the coupling itself is
}

TEST(StiffnessForm, OfACupIsTheSameFromAllSidesAndInAMirrorAlongItsAxis) {
  const Matrix6 K = cup::as_matrix(kFormCup);
  for (const double angle : {0.3, 1.57, -2.1}) {
    EXPECT_LT((seen_from(exp_rotation(Vector3(0.0, 0.0, angle)), K) - K).norm(), 1e-11 * K.norm()) << angle;
    const Vector3 normal(std::cos(angle), std::sin(angle), 0.0);
    EXPECT_LT((mirrored(normal, K) - K).norm(), 1e-11 * K.norm()) << angle;
  }
  EXPECT_GT((seen_from(exp_rotation(Vector3(0.3, 0.0, 0.0)), K) - K).norm(), 0.1 * K.norm());
}

TEST(SymmetryConditions, HoldForEveryCupAndLeaveFiveNumbersFree) {
  const SymmetryConditions& conditions = symmetry_conditions();
  ASSERT_EQ(conditions.rows.rows(), 16);
  ASSERT_EQ(conditions.names.size(), 16U);
  EXPECT_EQ((conditions.rows * full_numbers(cup::as_matrix(kFormCup))).norm(), 0.0);
  // 16 conditions that do not repeat each other: 21 - 16 numbers are free, and five bases span them.
  EXPECT_GT(numerics::symmetric_eigenpairs(conditions.rows * conditions.rows.transpose()).values[0], 0.5);
  for (const Form::Number& number : form_of(StiffnessForm::Symmetric).numbers)
    EXPECT_EQ((conditions.rows * full_numbers(number.basis)).norm(), 0.0) << number.name;
}

TEST(SymmetryConditions, AreBrokenByTheirOwnNumberAlone) {
  // Each number that a cup's symmetry forbids or ties breaks one condition, whose name has it.
  const SymmetryConditions& conditions = symmetry_conditions();
  const Form& full = form_of(StiffnessForm::Full);
  int free = 0;
  for (const Form::Number& number : full.numbers) {
    SCOPED_TRACE(number.name);
    const Eigen::VectorXd broken = conditions.rows * full_numbers(number.basis);
    const auto count = (broken.array() != 0.0).count();
    if (count == 0) {
      ++free;
      continue;
    }
    ASSERT_EQ(count, 1);
    Eigen::Index which = 0;
    (void)broken.cwiseAbs().maxCoeff(&which);
    EXPECT_NE(conditions.names[static_cast<std::size_t>(which)].find(number.name), std::string::npos);
  }
  EXPECT_EQ(free, 2);  // k_z_z and k_rz_rz; the other three are ties of two
}

TEST(SymmetryConditions, HoldForTheMeanOverAllSidesOfAnyStiffnessAndItsMirrorImage) {
  // What is averaged over turns about z and mirrored at a plane through z is as symmetric as a cup.
  Rng rng = Rng(9).split("mean");
  const Matrix6 K = any_stiffness(rng);
  Matrix6 mean = Matrix6::Zero();
  constexpr int kSides = 8;  // products of two vectors: turns by quarters of pi average them exactly
  for (int k = 0; k < kSides; ++k) {
    const Matrix6 turned = seen_from(exp_rotation(Vector3(0.0, 0.0, 2.0 * std::numbers::pi * k / kSides)), K);
    mean += (turned + mirrored(Vector3::UnitX(), turned)) / (2.0 * kSides);
  }
  const Eigen::VectorXd missed = symmetry_conditions().rows * full_numbers(mean);
  EXPECT_LT(missed.cwiseAbs().maxCoeff(), 1e-10 * K.norm());
  EXPECT_GT((symmetry_conditions().rows * full_numbers(K)).cwiseAbs().maxCoeff(), 1.0);
  // And the five numbers nearest to K are those of the mean.
  EXPECT_LT((cup::as_matrix(nearest_elasticity(K)) - mean).norm(), 1e-10 * K.norm());
}

TEST(NearestElasticity, IsTheMatrixItselfWhereItIsACups) {
  EXPECT_EQ(nearest_elasticity(cup::as_matrix(kFormCup)), kFormCup);
}

TEST(NearestElasticity, LeavesNoSmallerSumOfSquares) {
  Rng rng = Rng(4).split("nearest");
  const Matrix6 K = any_stiffness(rng);
  const model::CupElasticity best = nearest_elasticity(K);
  const double least = (cup::as_matrix(best) - K).squaredNorm();
  for (const Form::Number& number : form_of(StiffnessForm::Symmetric).numbers)
    for (const double step : {0.01, -0.01})
      EXPECT_GT((cup::as_matrix(best) + step * number.basis - K).squaredNorm(), least) << number.name;
}

}  // namespace
}  // namespace snug::identification::internal
