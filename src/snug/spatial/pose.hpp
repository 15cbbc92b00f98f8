// Pose, Twist, Wrench, SpatialInertia: the values that every other module speaks in.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace snug {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Quaternion = Eigen::Quaterniond;

/// Rigid transform X_AB: maps a point p_BQ to p_AQ = R p_BQ + p.
struct Pose {
  Matrix3 R = Matrix3::Identity();  ///< R_AB, orthonormal
  Vector3 p = Vector3::Zero();      ///< p_AB, m

  [[nodiscard]] Pose operator*(const Pose& other) const { return {R * other.R, R * other.p + p}; }
  [[nodiscard]] Vector3 operator*(const Vector3& point) const { return R * point + p; }
  [[nodiscard]] Pose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
  bool operator==(const Pose&) const = default;
};

/// Velocity of a frame: linear part at the frame's origin [m/s], angular part [rad/s].
struct Twist {
  Vector3 linear = Vector3::Zero();
  Vector3 angular = Vector3::Zero();
  bool operator==(const Twist&) const = default;
};

/// Force [N] and torque [Nm] about the origin of the frame named.
struct Wrench {
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
  bool operator==(const Wrench&) const = default;
};

/// Mass [kg], centre of mass in the body frame [m], rotational inertia about the centre of mass, body axes [kg m^2].
struct SpatialInertia {
  double mass = 1.0;
  Vector3 com = Vector3::Zero();
  Matrix3 inertia = Matrix3::Identity();
  bool operator==(const SpatialInertia&) const = default;
};

/// [linear; angular] and [force; torque]: the order of report equations (2) and (3).
[[nodiscard]] inline Vector6 as_vector(const Twist& V) { return (Vector6() << V.linear, V.angular).finished(); }
[[nodiscard]] inline Vector6 as_vector(const Wrench& F) { return (Vector6() << F.force, F.torque).finished(); }
[[nodiscard]] inline Twist twist_from(const Vector6& v) { return {v.head<3>(), v.tail<3>()}; }
[[nodiscard]] inline Wrench wrench_from(const Vector6& f) { return {f.head<3>(), f.tail<3>()}; }

/// Skew matrix a^ with a^ b = a x b.
[[nodiscard]] Matrix3 skew(const Vector3& a);
/// Rotation by |w| radians about w. Exact to rounding for any size, including zero.
[[nodiscard]] Matrix3 exp_rotation(const Vector3& w);
[[nodiscard]] Quaternion exp_quaternion(const Vector3& w);
/// Rotation vector of R, length in [0, pi]; at pi the sign of the axis is fixed (first non-zero entry positive).
[[nodiscard]] Vector3 log_rotation(const Matrix3& R);
/// Angle between two rotations, in [0, pi], accurate near 0 and pi.
[[nodiscard]] double angle_between(const Matrix3& R_A, const Matrix3& R_B);
/// Nearest rotation to an almost orthonormal matrix.
[[nodiscard]] Matrix3 orthonormalized(const Matrix3& R);

}  // namespace snug
