// Statics: where a held load hangs at rest.
#pragma once

#include "snug/cup/law.hpp"

namespace snug::cup {

/// A load held by one cup whose gripper stands still.
struct HeldLoad {
  Matrix3 R_WE = Matrix3::Identity();             ///< orientation of the gripper
  double mass = 1.0;                              ///< kg
  Vector3 p_SBcm = Vector3::Zero();               ///< centre of mass in the lip frame, m
  Matrix6 K = Matrix6::Identity();                ///< stiffness at S1
  Pose X_ES2;                                     ///< undeformed spring frame on the gripper
  Pose X_SS1;                                     ///< spring frame on the package
  Vector3 gravity_W = Vector3(0.0, 0.0, -9.81);   ///< m/s^2
};

enum class SettleStatus {
  Settled,       ///< residual below tolerance
  OutOfRange,    ///< bending passed 45 degrees on the way: the law has softened, no equilibrium of use beyond
  NotConverged,  ///< iterations ran out or the step length vanished
};

struct SettleResult {
  SettleStatus status = SettleStatus::NotConverged;
  Pose X_ES;                   ///< lip in the gripper frame; the best found when not settled
  bool is_stable = false;      ///< settled, and the symmetrised tangent is positive definite
  double residual = 0.0;       ///< N, norm of [force; torque / 50 mm] at S
  double min_tangent = 0.0;    ///< smallest eigenvalue of the symmetrised tangent at S (torque rows not scaled)
  int iterations = 0;          ///< Newton steps, all load steps together
  CupShape shape;
};

struct SettleOptions {
  int load_steps = 8;          ///< the load grows in this many equal parts, from the undeformed cup on
  int max_iterations = 60;     ///< per load step
  double tolerance = 1e-11;    ///< of the residual, relative to the weight (absolute below 1 N)
};

/// Equilibrium of spring and gravity, on the branch that starts at the undeformed cup: damped Newton with the exact
/// tangent and load stepping (docs/theory/cup.md, section 4).
[[nodiscard]] SettleResult settle(const HeldLoad& load, const SettleOptions& options = {});

/// Name as printed: settled, out_of_range, not_converged.
[[nodiscard]] const char* name_of(SettleStatus status) noexcept;

}  // namespace snug::cup
