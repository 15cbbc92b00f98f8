// Inverse dynamics: recursive Newton-Euler in world axes, and the load that a sensor at the flange carries.
#include "snug/robot/dynamics.hpp"

namespace snug::robot {
namespace {

/// Motion of one segment: turn rate, its derivative, and the acceleration of its origin less gravity, in W.
struct SegmentMotion {
  Vector3 w = Vector3::Zero();
  Vector3 alpha = Vector3::Zero();
  Vector3 a = Vector3::Zero();
};

using SegmentMotions = std::array<SegmentMotion, kMaxMoving + 1>;

/// Outward pass. An upward acceleration of the base by -gravity weighs all masses.
SegmentMotions move_segments(const ArmModel& arm, const ArmPose& at, const JointVector& qd, const JointVector& qdd,
                             const Vector3& gravity_W) noexcept {
  SegmentMotions motions;
  motions[0].a = -gravity_W;
  for (std::size_t i = 0; i < arm.moving_count(); ++i) {
    const MovingJoint moving = arm.moving(i);
    const SegmentMotion& before = motions[i];
    SegmentMotion& after = motions[i + 1];
    const Vector3& axis = at.axis_W[i];
    const double rate = moving.rate(qd), rate_change = moving.rate(qdd);
    const Vector3 r = at.X_WS[i + 1].p - at.X_WS[i].p;
    after = before;
    after.a += before.alpha.cross(r) + before.w.cross(before.w.cross(r));
    if (moving.joint.kind == JointKind::Revolute) {
      after.w += axis * rate;
      after.alpha += axis * rate_change + before.w.cross(axis) * rate;
    } else {
      after.a += axis * rate_change + 2.0 * before.w.cross(axis) * rate;
    }
  }
  return motions;
}

/// Wrench that accelerates a body like this, about `p_WO`; X_WB is the body's frame, which moves with `motion`.
Wrench inertial_wrench(const SpatialInertia& body, const Pose& X_WB, const Vector3& p_WS, const SegmentMotion& motion,
                       const Vector3& p_WO) noexcept {
  const Vector3 p_WBcm = X_WB * body.com;
  const Vector3 r = p_WBcm - p_WS;
  const Vector3 a = motion.a + motion.alpha.cross(r) + motion.w.cross(motion.w.cross(r));
  const Matrix3 M_W = X_WB.R * body.inertia * X_WB.R.transpose();
  Wrench F;
  F.force = body.mass * a;
  F.torque = M_W * motion.alpha + motion.w.cross(M_W * motion.w) + (p_WBcm - p_WO).cross(F.force);
  return F;
}

/// `forces`: that the joints pass on, each in its own frame; may be absent. A joint drives those that follow it, too.
JointVector solve_torques(const ArmModel& arm, const ArmPose& at, const SegmentMotions& motions, const Wrench& F_Eo_W,
                          std::array<Vector3, kMaxJoints>* forces = nullptr) noexcept {
  JointVector tau = JointVector::Zero(arm.joint_count());
  // Inward: the wrench that a segment needs from the joint before it, about its origin.
  Wrench needed{-F_Eo_W.force, -F_Eo_W.torque};
  Vector3 about = at.X_WE.p;
  for (std::size_t k = arm.moving_count(); k >= 1; --k) {
    const MovingJoint moving = arm.moving(k - 1);
    const Vector3& origin = at.X_WS[k].p;
    const Wrench own = inertial_wrench(arm.segments[k], at.X_WS[k], origin, motions[k], origin);
    needed.torque += own.torque + (about - origin).cross(needed.force);
    needed.force += own.force;
    about = origin;
    const bool turns = moving.joint.kind == JointKind::Revolute;
    const double load = at.axis_W[k - 1].dot(turns ? needed.torque : needed.force);
    if (arm.followers.empty())
      tau(moving.q) = load;
    else
      tau(moving.q) += moving.ratio() * load;
    if (forces != nullptr && moving.follower == nullptr)
      (*forces)[static_cast<std::size_t>(moving.q)] = at.X_WS[k].R.transpose() * needed.force;
  }
  return tau;
}

}  // namespace

JointVector inverse_dynamics(const ArmModel& arm, const ArmMotion& motion, const Wrench& F_Eo_W,
                             const Vector3& gravity_W) noexcept {
  const ArmPose at = forward(arm, motion.q);
  return solve_torques(arm, at, move_segments(arm, at, motion.qd, motion.qdd, gravity_W), F_Eo_W);
}

std::array<Vector3, kMaxJoints> joint_forces(const ArmModel& arm, const ArmMotion& motion, const Wrench& F_Eo_W,
                                             const Vector3& gravity_W) noexcept {
  const ArmPose at = forward(arm, motion.q);
  std::array<Vector3, kMaxJoints> forces;
  forces.fill(Vector3::Zero());
  (void)solve_torques(arm, at, move_segments(arm, at, motion.qd, motion.qdd, gravity_W), F_Eo_W, &forces);
  return forces;
}

JointMatrix mass_matrix(const ArmModel& arm, const JointVector& q) noexcept {
  const int n = arm.joint_count();
  const ArmPose at = forward(arm, q);
  const JointVector rest = JointVector::Zero(n);
  JointMatrix M(n, n);
  for (int i = 0; i < n; ++i) {
    JointVector unit = rest;
    unit(i) = 1.0;
    M.col(i) = solve_torques(arm, at, move_segments(arm, at, rest, unit, Vector3::Zero()), Wrench{});
  }
  const JointMatrix transposed = M.transpose();
  return 0.5 * (M + transposed);
}

Wrench sensor_wrench(const ArmModel& arm, const ArmMotion& motion, int sensor_link, const SpatialInertia& load,
                     const Wrench& F_Eo_W, const Vector3& gravity_W) noexcept {
  const ArmPose at = forward(arm, motion.q);
  const SegmentMotions motions = move_segments(arm, at, motion.qd, motion.qdd, gravity_W);
  const Pose X_WL = link_pose(arm, at, sensor_link);
  const std::size_t last = arm.moving_count();
  const Wrench own = inertial_wrench(load, X_WL, at.X_WS[last].p, motions[last], X_WL.p);
  const Vector3 force = F_Eo_W.force - own.force;
  const Vector3 torque = F_Eo_W.torque + (at.X_WE.p - X_WL.p).cross(F_Eo_W.force) - own.torque;
  return {X_WL.R.transpose() * force, X_WL.R.transpose() * torque};
}

}  // namespace snug::robot
