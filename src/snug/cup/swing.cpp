// Swing: how slowly a held box swings under the cup, for motions that shall not leave it swinging.
#include "snug/cup/swing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/cup/law.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::cup {

Swing find_swing(const model::CupParams& params, const SpatialInertia& box_S, double gravity) {
  // About the centre of the cup, in S: the spring's ends meet there while nothing is deformed.
  const Vector3 r = box_S.com + Vector3(0.0, 0.0, params.centre_from_lip);
  Matrix6 M = Matrix6::Zero();
  M.topLeftCorner<3, 3>() = box_S.mass * Matrix3::Identity();
  M.bottomLeftCorner<3, 3>() = box_S.mass * skew(r);
  M.topRightCorner<3, 3>() = M.bottomLeftCorner<3, 3>().transpose();
  M.bottomRightCorner<3, 3>() = box_S.inertia - box_S.mass * skew(r) * skew(r);
  Matrix6 K = as_matrix(params.stiffness);
  K(3, 3) += box_S.mass * gravity * r.z();
  K(4, 4) += box_S.mass * gravity * r.z();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (!is_positive_definite(M) || !is_positive_definite(K)) return {kNever, kNever};
  // M x = w^-2 K x: the eigenvalues of L^-1 M L^-T with K = L L^T.
  const Matrix6 to_unit = inverse(cholesky(K));
  const Vector6 squares = symmetric_eigenvalues(to_unit * M * to_unit.transpose());
  const auto period = [&](Eigen::Index i) { return 2.0 * std::numbers::pi * std::sqrt(squares[i]); };
  return {period(5), period(4)};
}

SpatialInertia box_below_lip(const model::CupParams& params, const SpatialInertia& box, const Vector3& size,
                             const Vector3& up_P) {
  Matrix3 R_PS;
  R_PS.col(2) = -up_P;
  R_PS.col(0) = up_P.unitOrthogonal();
  R_PS.col(1) = R_PS.col(2).cross(R_PS.col(0));
  const double room = 0.5 * params.effective_diameter;
  Vector3 p_PS = 0.5 * size.cwiseProduct(up_P);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(up_P[i]) > 0.5) continue;
    const double most = std::max(0.0, 0.5 * size[i] - room);
    p_PS[i] = std::clamp(box.com[i], -most, most);
  }
  const Matrix3 R_SP = R_PS.transpose();
  return {box.mass, R_SP * (box.com - p_PS), R_SP * box.inertia * R_PS};
}

Swing find_swing(const model::CupParams& params, const SpatialInertia& box, const Vector3& size, const Vector3& up_P,
                 double gravity) {
  return find_swing(params, box_below_lip(params, box, size, up_P), gravity);
}

}  // namespace snug::cup
