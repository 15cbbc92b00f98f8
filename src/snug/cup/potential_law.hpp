// A cup's law whose stiffness depends on its compression (docs/theory/cup.md, section 8): energy, wrench, tangent.
#pragma once

#include "snug/model/cup_law.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup {

/// Coefficients of the law, in this order: axial_0 .. axial_5, lateral_0 .. lateral_2, bend_0 .. bend_2,
/// coupling_0 .. coupling_2, torsion_0, torsion_1.
inline constexpr int kLawTerms = 17;

/// V and dV/dq of each coefficient at 1. q = e / 2 of law.hpp's deformation.
struct LawTerms {
  Eigen::Matrix<double, 1, kLawTerms> energy;
  Eigen::Matrix<double, 6, kLawTerms> gradient = Eigen::Matrix<double, 6, kLawTerms>::Zero();
};
[[nodiscard]] LawTerms law_terms(const Vector6& q, double middle, double half_range);

/// Of the spring: energy, J; wrench on the package in S1 about its origin; its derivative by the body twist of S1 in
/// S2.
struct LawResponse {
  double energy = 0.0;
  Vector6 wrench;
  Matrix6 tangent;
};
[[nodiscard]] LawResponse law_response(const model::CupLaw& law, const Pose& H);

/// The same of a cup: by its law where that is used, else by its stiffness K (law.hpp).
[[nodiscard]] LawResponse spring_response(const Pose& H, const Matrix6& K, const model::CupLaw& law);
[[nodiscard]] Vector6 spring_wrench(const Pose& H, const Matrix6& K, const model::CupLaw& law);
[[nodiscard]] Matrix6 spring_tangent(const Pose& H, const Matrix6& K, const model::CupLaw& law);

}  // namespace snug::cup
