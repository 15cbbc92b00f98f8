// Contact law: the laws of generalized Newton steps and of the augmented Lagrangian.
#include "snug/physics/internal/contact_law.hpp"

#include <cmath>

namespace snug::physics::internal {

ContactStatus generalized_law(const Row& row, double penalty, const double (&xi)[3], LinearLaw& law) {
  (void)open_law(law);
  const double* lambda = row.lambda;
  const double normal = xi[0] - row.target + row.gamma * lambda[0];
  const double z0 = lambda[0] - normal / row.W[0];
  if (z0 <= 0.0) return ContactStatus::Open;
  const double rigid = penalty / rigid_mobility(row);
  const double c = rigid / (1.0 + rigid * row.gamma);
  law.lambda[0] = lambda[0] - c * normal;
  law.slope[0] = c;
  const double z1 = lambda[1] - row.step_t * xi[1], z2 = lambda[2] - row.step_t * xi[2];
  const double limit = row.mu * std::max(lambda[0], z0), square = z1 * z1 + z2 * z2;
  if (square <= limit * limit) {
    const double t = penalty * row.step_t;
    law.lambda[1] = lambda[1] - t * xi[1], law.lambda[2] = lambda[2] - t * xi[2];
    law.slope[4] = law.slope[8] = t;
    return ContactStatus::Sticks;
  }
  // Along z the friction is at its limit. Across, lambda = limit/|z| (lambda - s xi) is solved for lambda.
  const double length = std::sqrt(square);
  const double d1 = z1 / length, d2 = z2 / length;
  const double share = std::min(limit / length, 1.0 - 1.0 / penalty);
  const double s = share * row.step_t / (1.0 - share);
  const double across = s * (d1 * xi[2] - d2 * xi[1]);
  law.lambda[1] = row.mu * law.lambda[0] * d1 + across * d2;
  law.lambda[2] = row.mu * law.lambda[0] * d2 - across * d1;
  law.slope[3] = row.mu * d1 * c, law.slope[6] = row.mu * d2 * c;
  law.slope[4] = s * d2 * d2;
  law.slope[5] = law.slope[7] = -s * d1 * d2;
  law.slope[8] = s * d1 * d1;
  return ContactStatus::Slides;
}

void augmented_law(const Row& row, double penalty_n, double penalty_t, const double* center, const double (&xi)[3],
                   LinearLaw& law) {
  std::fill_n(law.slope, 9, 0.0);
  std::fill_n(law.lambda, 3, 0.0);
  const double c = penalty_n / (1.0 + penalty_n * row.gamma);
  const double normal = center[0] / (1.0 + penalty_n * row.gamma) - c * (xi[0] - row.target);
  if (normal <= 0.0) return;
  const double z1 = center[1] - penalty_t * xi[1], z2 = center[2] - penalty_t * xi[2];
  const double square = z1 * z1 + z2 * z2, limit = row.mu * normal;
  law.lambda[0] = normal;
  law.slope[0] = c;
  if (square <= limit * limit) {
    law.lambda[1] = z1, law.lambda[2] = z2;
    law.slope[4] = law.slope[8] = penalty_t;
    return;
  }
  const double length = std::sqrt(square);
  const double d1 = z1 / length, d2 = z2 / length, turn = penalty_t * limit / length;
  law.lambda[1] = limit * d1, law.lambda[2] = limit * d2;
  law.slope[3] = row.mu * d1 * c, law.slope[6] = row.mu * d2 * c;
  law.slope[4] = turn * (1.0 - d1 * d1);
  law.slope[5] = law.slope[7] = -turn * d1 * d2;
  law.slope[8] = turn * (1.0 - d2 * d2);
}

}  // namespace snug::physics::internal
