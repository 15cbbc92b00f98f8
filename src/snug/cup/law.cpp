// The law of the suction cup while it holds: potential, spring wrench and their exact derivatives on SE(3).
#include "snug/cup/law.hpp"

#include <cmath>

#include "snug/cup/law_derivatives.hpp"

namespace snug::cup {
namespace {

Vector3 odd_part(const Matrix3& R) { return {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)}; }

}  // namespace

Matrix6 deformation_jacobian(const Pose& H) {
  Matrix6 J;
  J << Matrix3::Identity() + H.R, skew(H.R.transpose() * H.p),  //
      Matrix3::Zero(), H.R.trace() * Matrix3::Identity() - H.R.transpose();
  return J;
}

Matrix6 pullback_derivative(const Pose& H, const Vector6& y) {
  const Vector3 y1 = y.head<3>(), y2 = y.tail<3>();
  const Vector3 a = H.R.transpose() * H.p;
  Matrix6 G;
  G << Matrix3::Zero(), skew(H.R.transpose() * y1),  //
      skew(y1), skew(y1) * skew(a) - y2 * odd_part(H.R).transpose() + H.R * skew(y2);
  return G;
}

Matrix6 as_matrix(const model::CupElasticity& elasticity) {
  Matrix6 K = Matrix6::Zero();
  K.diagonal() << elasticity.lateral, elasticity.lateral, elasticity.axial, elasticity.bend, elasticity.bend,
      elasticity.torsion;
  K(0, 4) = K(4, 0) = elasticity.coupling;
  K(1, 3) = K(3, 1) = -elasticity.coupling;
  return K;
}

Vector6 deformation(const Pose& H) {
  const Vector3& o = H.p;
  Vector6 e;
  // (I + R^T) o rather than o + R^T o: near a half turn the sum of the matrices cancels exactly, that of the vectors
  // does not. What is left there is rounding, and the fused sums in this order round as the reference vectors do.
  for (int i = 0; i < 3; ++i) {
    Vector3 row = H.R.col(i);
    row[i] += 1.0;
    e[i] = std::fma(row[2], o[2], std::fma(row[0], o[0], row[1] * o[1]));
  }
  e.tail<3>() = odd_part(H.R);
  return e;
}

double potential(const Pose& H, const Matrix6& K) {
  const Vector6 e = deformation(H);
  return e.dot(K * e) / 8.0;
}

Vector6 spring_wrench(const Pose& H, const Matrix6& K) {
  const Vector6 y = K * deformation(H);
  const Vector3 y1 = y.head<3>(), y2 = y.tail<3>();
  const Vector3 a = H.R.transpose() * H.p;
  Vector6 wrench;
  wrench << y1 + H.R.transpose() * y1, y1.cross(a) + H.R.trace() * y2 - H.R * y2;
  return -0.25 * wrench;
}

Matrix6 spring_tangent(const Pose& H, const Matrix6& K) {
  const Matrix6 J = deformation_jacobian(H);
  return -0.25 * (pullback_derivative(H, K * deformation(H)) + J.transpose() * K * J);
}

Matrix6 wrench_transform(const Pose& X_SS1) {
  Matrix6 X;
  X << X_SS1.R, Matrix3::Zero(), skew(X_SS1.p) * X_SS1.R, X_SS1.R;
  return X;
}

double bend_angle(const Matrix3& R) { return std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2)); }

}  // namespace snug::cup
