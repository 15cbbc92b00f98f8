// Cup law: energy, wrench and exact tangent of a 6D spring on SE(3), and the reduced stiffness of a round cup.
#pragma once

#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup {

// Frames (docs/theory/cup.md): E and S2 ride on the gripper, S (the lip) and S1 on the package; z of all four is the
// cup axis, from gripper to package. H = X_S2S1 is the deformation; H = identity is the undeformed cup.
// 6-vectors are [linear; angular] and [force; torque].

/// Five numbers of a round, mirror-symmetric cup; the same pattern serves damping.
using CupStiffness = model::CupElasticity;

/// The 6x6 matrix of the pattern: diag(lateral, lateral, axial, bend, bend, torsion) and (x, ry) = +c, (y, rx) = -c.
[[nodiscard]] Matrix6 make_matrix(const CupStiffness& elasticity) noexcept;

/// True when the pattern is positive definite: all diagonal entries > 0 and lateral * bend > coupling^2.
[[nodiscard]] bool is_positive_definite(const CupStiffness& elasticity) noexcept;

/// X* of X_AB: maps a wrench on a body given at and in B to the same wrench at and in A. Its transpose maps a twist
/// given at and in A to the twist of the same body at and in B.
[[nodiscard]] Matrix6 make_wrench_map(const Pose& X_AB) noexcept;

/// e(H) = [(I + R^T) o; (R - R^T)^vee]: twice the odd part of H; 2 xi to second order for H = exp(xi). m and rad.
[[nodiscard]] Vector6 compute_deformation(const Pose& X_S2S1) noexcept;

/// V = e^T K e / 8, J. Bounded in R: zero again at rotations by pi, so only meaningful below 45 degrees of bending.
[[nodiscard]] double compute_energy(const Pose& X_S2S1, const Matrix6& K) noexcept;

/// What the spring does at one deformation, all at and in S1.
struct SpringResponse {
  double energy = 0.0;                 ///< J
  Vector6 wrench = Vector6::Zero();    ///< on the package
  Matrix6 tangent = Matrix6::Zero();   ///< d wrench / d (body twist displacement of S1: H exp(nu)); components in S1
};

/// Report eq. (3) without its outer matrix: wrench on the package at and in S1.
[[nodiscard]] Vector6 compute_wrench(const Pose& X_S2S1, const Matrix6& K) noexcept;

/// Energy, wrench and exact tangent together (docs/theory/cup.md, eqs 3 to 6).
[[nodiscard]] SpringResponse compute_response(const Pose& X_S2S1, const Matrix6& K) noexcept;

/// Wrench on the gripper at and in S2 that balances compute_wrench.
[[nodiscard]] Vector6 compute_reaction(const Pose& X_S2S1, const Matrix6& K) noexcept;

/// How a cup is bent, twisted and stretched, for people and limits.
struct CupShape {
  double bend = 0.0;        ///< rad, angle between the z axes of S2 and S1, in [0, pi]
  double torsion = 0.0;     ///< rad, turn about z that remains, in (-pi, pi]
  double elongation = 0.0;  ///< m, along S2z, positive when stretched
  double shear = 0.0;       ///< m, distance of S1's origin from the S2z axis
};
[[nodiscard]] CupShape measure_shape(const Pose& X_S2S1) noexcept;

}  // namespace snug::cup
