// The law of the suction cup while it holds: potential, spring wrench and their exact derivatives on SE(3).
#pragma once

#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup {

/// The 6 x 6 matrix, linear part first, of the five axially symmetric numbers: see model::CupElasticity.
[[nodiscard]] Matrix6 as_matrix(const model::CupElasticity& elasticity);

/// Deformation e(H) = [(I + R^T) o; (R - R^T)^vee] of H = S2_H_S1 = (R, o): twice the odd part of H.
[[nodiscard]] Vector6 deformation(const Pose& H);

/// Stored energy V(H) = e^T K e / 8, J. Bounded in R: valid below 45 degrees of bending.
[[nodiscard]] double potential(const Pose& H, const Matrix6& K);

/// Spring wrench on the package, in S1 about its origin: the bracket of report eq. (3).
[[nodiscard]] Vector6 spring_wrench(const Pose& H, const Matrix6& K);

/// d spring_wrench / d nu, nu = [v; w] the body twist of S1 in S2.
[[nodiscard]] Matrix6 spring_tangent(const Pose& H, const Matrix6& K);

/// X*: maps a wrench in S1 about its origin to the same wrench in S about its origin.
[[nodiscard]] Matrix6 wrench_transform(const Pose& X_SS1);

/// Angle between the z axes of the two ends, rad: the bending of the cup.
[[nodiscard]] double bend_angle(const Matrix3& R);

}  // namespace snug::cup
