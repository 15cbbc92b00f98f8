// Kinematics: forward chain, Jacobians, and how near to singular they are.
#include "snug/robot/kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "snug/spatial/matrix6.hpp"

namespace snug::robot {
namespace {

/// Rotation by `angle` about a unit axis (Rodrigues); turns about z, all of a usual URDF, cost two products.
Matrix3 turn(const Vector3& axis, double angle) noexcept {
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  const Vector3 u = (1.0 - c) * axis;
  Matrix3 R;
  R << c + u.x() * axis.x(), u.x() * axis.y() - s * axis.z(), u.x() * axis.z() + s * axis.y(),
      u.y() * axis.x() + s * axis.z(), c + u.y() * axis.y(), u.y() * axis.z() - s * axis.x(),
      u.z() * axis.x() - s * axis.y(), u.z() * axis.y() + s * axis.x(), c + u.z() * axis.z();
  return R;
}

}  // namespace

ArmPose forward(const ArmModel& arm, const JointVector& q) noexcept {
  ArmPose at;
  at.X_WS[0] = arm.X_WB;
  const std::size_t count = arm.moving_count();
  for (std::size_t i = 0; i < count; ++i) {
    const MovingJoint moving = arm.moving(i);
    const Joint& joint = moving.joint;
    const double value = moving.position(q);
    const Pose X_WJ = at.X_WS[i] * joint.X_SJ;
    at.axis_W[i] = X_WJ.R * joint.axis;
    if (joint.kind == JointKind::Revolute)
      at.X_WS[i + 1] = {X_WJ.R * turn(joint.axis, value), X_WJ.p};
    else
      at.X_WS[i + 1] = {X_WJ.R, X_WJ.p + value * at.axis_W[i]};
  }
  at.X_WE = at.X_WS[count] * arm.X_SE;
  return at;
}

Pose forward_tool(const ArmModel& arm, const JointVector& q) noexcept {
  Pose X_WS = arm.X_WB;
  for (std::size_t i = 0; i < arm.moving_count(); ++i) {
    const MovingJoint moving = arm.moving(i);
    const Joint& joint = moving.joint;
    const double value = moving.position(q);
    X_WS = X_WS * joint.X_SJ;
    if (joint.kind == JointKind::Revolute)
      X_WS.R = X_WS.R * turn(joint.axis, value);
    else
      X_WS.p += value * (X_WS.R * joint.axis);
  }
  return X_WS * arm.X_SE;
}

Jacobian point_jacobian(const ArmModel& arm, const ArmPose& at, int segment, const Vector3& p_WQ) noexcept {
  Jacobian J = Jacobian::Zero(6, arm.joint_count());
  for (std::size_t i = 0; i < static_cast<std::size_t>(segment); ++i) {
    const MovingJoint moving = arm.moving(i);
    const Vector3& axis = at.axis_W[i];
    Vector6 column = Vector6::Zero();
    if (moving.joint.kind == JointKind::Revolute) {
      column << axis.cross(p_WQ - at.X_WS[i + 1].p), axis;
    } else {
      column.head<3>() = axis;
    }
    if (arm.followers.empty())
      J.col(moving.q) = column;
    else
      J.col(moving.q) += moving.ratio() * column;
  }
  return J;
}

Jacobian tool_jacobian(const ArmModel& arm, const ArmPose& at) noexcept {
  return point_jacobian(arm, at, arm.last_segment(), at.X_WE.p);
}

Vector6 tool_bias_acceleration(const ArmModel& arm, const ArmPose& at, const JointVector& qd) noexcept {
  // Velocities and bias accelerations of the joint origins, outward; then of E.
  Vector3 w = Vector3::Zero();
  Vector3 alpha = Vector3::Zero();
  Vector3 a = Vector3::Zero();
  Vector3 origin = at.X_WS[0].p;
  for (std::size_t i = 0; i < arm.moving_count(); ++i) {
    const MovingJoint moving = arm.moving(i);
    const Vector3& axis = at.axis_W[i];
    const double rate = moving.rate(qd);
    const Vector3 r = at.X_WS[i + 1].p - origin;
    a += alpha.cross(r) + w.cross(w.cross(r));
    origin = at.X_WS[i + 1].p;
    if (moving.joint.kind == JointKind::Revolute) {
      alpha += w.cross(axis) * rate;
      w += axis * rate;
    } else {
      a += 2.0 * w.cross(axis) * rate;
    }
  }
  const Vector3 r = at.X_WE.p - origin;
  a += alpha.cross(r) + w.cross(w.cross(r));
  return (Vector6() << a, alpha).finished();
}

Twist segment_twist(const ArmModel& arm, const ArmPose& at, const JointVector& qd, int segment) noexcept {
  const Vector3& p = at.X_WS[static_cast<std::size_t>(segment)].p;
  return twist_from(point_jacobian(arm, at, segment, p) * qd);
}

Matrix6 gram(const Jacobian& J) noexcept { return J * J.transpose(); }

double singularity_measure(const Jacobian& J_WE, double length) noexcept {
  // The smallest singular value from J J^T, which has 6 - n eigenvalues of zero more where n < 6 joints move the tool.
  Jacobian scaled = J_WE;
  scaled.topRows<3>() /= length;
  return std::sqrt(std::max(0.0, symmetric_eigenvalues(gram(scaled))(6 - std::min<Eigen::Index>(6, J_WE.cols()))));
}

}  // namespace snug::robot
