// settle: where a load comes to rest under a held cup, found without simulating.
#pragma once

#include "snug/cup/law.hpp"

namespace snug::cup {

/// A load hanging from a cup. Only the directions of W matter, so the gripper's position is not asked for.
struct HeldLoad {
  Matrix3 R_WE = Matrix3::Identity();  ///< of the gripper's end
  double mass = 1.0;                   ///< kg, not negative
  Vector3 p_SScm = Vector3::Zero();    ///< centre of mass seen from the lip, in S, m
  Matrix6 stiffness =
      Matrix6::Identity();             ///< K in S1, symmetric and positive definite; with `law` its own, undeformed
  model::CupLaw law;                   ///< in place of `stiffness` where it is used
  Pose X_ES2;                          ///< spring's end on the gripper
  Pose X_SS1;                          ///< spring's end on the package
  Vector3 gravity_W{0.0, 0.0, -9.81};  ///< m/s^2
};

struct SettleOptions {
  int load_steps = 8;        ///< gravity is turned on in as many equal parts
  int max_iterations = 60;   ///< Newton steps for each part, and then for parts of parts
  double tolerance = 1e-12;  ///< of SettleResult::residual relative to the load; rounding comes on top
  double max_turn = 0.3;     ///< rad, of one Newton step
};

enum class SettleStatus {
  Converged,       ///< equilibrium found; `is_stable` says whether the load would stay there
  BeyondCapacity,  ///< more than the law can hold: no equilibrium on the branch from rest, or one bent by 45 degrees
  NotConverged,    ///< no more progress, and not because of the law: the residual says how far
  BadInput,        ///< NaN, negative mass, or a stiffness without inverse
};

[[nodiscard]] const char* name_of(SettleStatus status);

struct SettleResult {
  SettleStatus status = SettleStatus::NotConverged;
  Pose X_ES;                         ///< where the lip is; the last point reached when not converged
  Pose H;                            ///< deformation S2_H_S1 there
  bool is_stable = false;            ///< converged, and the smallest eigenvalue below is positive
  double residual = 0.0;             ///< N: norm of [force; 20/m x torque] left over at S1 under the whole load
  double load_fraction = 0.0;        ///< of gravity that is carried at X_ES: 1 when converged
  double smallest_eigenvalue = 0.0;  ///< of the symmetric part of the tangent stiffness at S
  double bend = 0.0;                 ///< rad, between the z axes of the two ends
  int iterations = 0;                ///< Newton steps in all
};

/// The equilibrium reached from the undeformed cup by turning gravity on slowly: load stepping, in each step Newton's
/// method on SE(3) with the exact tangent, a step limit and backtracking. docs/theory/cup.md, section 5.
[[nodiscard]] SettleResult settle(const HeldLoad& load, const SettleOptions& options = {});

}  // namespace snug::cup
