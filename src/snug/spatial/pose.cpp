// Pose, Twist, Wrench, SpatialInertia: the values that every other module speaks in.
#include "snug/spatial/pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace snug {

Matrix3 skew(const Vector3& a) {
  Matrix3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Quaternion exp_quaternion(const Vector3& w) {
  const double angle = w.norm();
  // sin(x/2)/x by its series below 1e-4: the first dropped term is x^4/3840 relative, below rounding.
  const double s = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * w.x(), s * w.y(), s * w.z()};
}

Matrix3 exp_rotation(const Vector3& w) { return exp_quaternion(w).toRotationMatrix(); }

Vector3 log_rotation(const Matrix3& R) {
  Quaternion quat(R);
  quat.normalize();
  Vector3 axis = quat.vec();
  double scalar = quat.w();
  if (scalar < 0.0) {
    axis = -axis;
    scalar = -scalar;
  }
  const double s = axis.norm();
  if (s < 1e-9) return 2.0 * axis;
  if (scalar < 1e-12) {  // rotation by pi: the axis has two signs, choose one
    for (int i = 0; i < 3; ++i) {
      if (std::abs(axis[i]) > 1e-9) {
        if (axis[i] < 0.0) axis = -axis;
        break;
      }
    }
  }
  return (2.0 * std::atan2(s, scalar) / s) * axis;
}

double angle_between(const Matrix3& R_A, const Matrix3& R_B) {
  const Quaternion quat(Matrix3(R_A.transpose() * R_B));
  return 2.0 * std::atan2(quat.vec().norm(), std::abs(quat.w()));
}

Matrix3 orthonormalized(const Matrix3& R) { return Quaternion(R).normalized().toRotationMatrix(); }

}  // namespace snug
