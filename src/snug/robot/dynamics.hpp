// Inverse dynamics of an arm, and what a force/torque sensor in it reads. Never allocates.
#pragma once

#include "snug/robot/kinematics.hpp"

namespace snug::robot {

/// Motion of the arm at one instant; all of arm.joint_count() entries.
struct ArmMotion {
  JointVector q;
  JointVector qd;
  JointVector qdd;
};

/// Torques that the joints must supply (recursive Newton-Euler): tau = M(q) qdd + C(q, qd) qd + G(q) - J^T F.
/// `F_Eo_W`: wrench that the world applies to the tool, torque about E's origin, in W. `gravity_W` [m/s^2] as in a
/// scenario: (0, 0, -9.81). No friction, no rotor inertia.
[[nodiscard]] JointVector inverse_dynamics(const ArmModel& arm, const ArmMotion& motion, const Wrench& F_Eo_W,
                                           const Vector3& gravity_W) noexcept;

/// Force that each joint passes on to the segment that it moves, N, in that segment's frame; zero behind the last. The
/// parameters are those of inverse_dynamics.
[[nodiscard]] std::array<Vector3, kMaxJoints> joint_forces(const ArmModel& arm, const ArmMotion& motion,
                                                           const Wrench& F_Eo_W, const Vector3& gravity_W) noexcept;

/// M(q), symmetric positive definite.
[[nodiscard]] JointMatrix mass_matrix(const ArmModel& arm, const JointVector& q) noexcept;

/// What a sensor in the frame L of `sensor_link` (in the last segment) reads that carries `load` (in L, from
/// distal_inertia): the wrench that the load applies to the arm through it, torque about L's origin, in L. At rest
/// with nothing held that is the load's weight.
[[nodiscard]] Wrench sensor_wrench(const ArmModel& arm, const ArmMotion& motion, int sensor_link,
                                   const SpatialInertia& load, const Wrench& F_Eo_W, const Vector3& gravity_W) noexcept;

}  // namespace snug::robot
