// Kinematics: where the segments and the tool of an arm are, and how fast they get there. Never allocates.
#pragma once

#include <array>

#include "snug/robot/arm.hpp"

namespace snug::robot {

/// Columns: twist of E for unit speed of each joint, linear part (at E's origin) first, in W.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;

/// Where everything is at one q.
struct ArmPose {
  std::array<Pose, kMaxMoving + 1> X_WS;   ///< segments 0 .. moving joints
  std::array<Vector3, kMaxMoving> axis_W;  ///< unit axis of each moving joint
  Pose X_WE;
};

/// Poses of all segments and of E. q has arm.joint_count() entries; limits are not looked at.
[[nodiscard]] ArmPose forward(const ArmModel& arm, const JointVector& q) noexcept;
/// X_WE only.
[[nodiscard]] Pose forward_tool(const ArmModel& arm, const JointVector& q) noexcept;

/// Pose of one link.
[[nodiscard]] inline Pose link_pose(const ArmModel& arm, const ArmPose& at, int link) noexcept {
  const Link& l = arm.links[static_cast<std::size_t>(link)];
  return at.X_WS[static_cast<std::size_t>(l.segment)] * l.X_SL;
}

/// J_WE: V_WE_W = J_WE qd.
[[nodiscard]] Jacobian tool_jacobian(const ArmModel& arm, const ArmPose& at) noexcept;
/// J_WQ for a point Q [m, W] that moves with `segment`; joints behind it add nothing.
[[nodiscard]] Jacobian point_jacobian(const ArmModel& arm, const ArmPose& at, int segment,
                                      const Vector3& p_WQ) noexcept;
/// d/dt(J_WE) qd: acceleration of E when qdd = 0, linear part first, in W.
[[nodiscard]] Vector6 tool_bias_acceleration(const ArmModel& arm, const ArmPose& at, const JointVector& qd) noexcept;

/// Twist of a segment, V_WS_W, linear part at the segment's origin.
[[nodiscard]] Twist segment_twist(const ArmModel& arm, const ArmPose& at, const JointVector& qd, int segment) noexcept;

/// J J^T
[[nodiscard]] Matrix6 gram(const Jacobian& J) noexcept;
/// How far from singular: smallest singular value of J_WE with its linear part divided by `length` [m] (a typical
/// reach, so that rows compare), 1/s per rad/s. 0 at a singularity.
[[nodiscard]] double singularity_measure(const Jacobian& J_WE, double length = 0.5) noexcept;

}  // namespace snug::robot
