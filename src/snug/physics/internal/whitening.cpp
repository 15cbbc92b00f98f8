// Whitening: from velocities to coordinates in which the mass disappears, and back.
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {

Whitening plain_whitening(const WorldModel::MassProperties& mass, const Matrix3& R_WB) {
  Whitening whitening;
  whitening.linear = std::sqrt(mass.inverse_mass);
  whitening.angular = (R_WB * mass.R_BI) * mass.inverse_inertia.cwiseSqrt().asDiagonal();
  return whitening;
}

Vector6 whiten(const Whitening& whitening, const Vector3& linear, const Vector3& angular) {
  Vector6 v;
  v << linear, angular;
  if (whitening.dense != nullptr) return whitening.dense->triangularView<Eigen::Upper>().solve(v);
  Vector6 u;
  u.head<3>() = linear / whitening.linear;
  // The columns of the angular part are orthogonal: its inverse is its transpose over the squared lengths.
  u.tail<3>() =
      (whitening.angular.transpose() * angular).cwiseQuotient(whitening.angular.colwise().squaredNorm().transpose());
  return u;
}

void unwhiten(const Whitening& whitening, const double* u, Vector3& linear, Vector3& angular) {
  const Eigen::Map<const Vector6> map(u);
  if (whitening.dense != nullptr) {
    const Vector6 v = whitening.dense->triangularView<Eigen::Upper>() * map;
    linear = v.head<3>();
    angular = v.tail<3>();
    return;
  }
  linear = whitening.linear * map.head<3>();
  angular = whitening.angular * map.tail<3>();
}

}  // namespace snug::physics::internal
