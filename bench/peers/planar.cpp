#include "peers/planar.hpp"

#include <cmath>

namespace snug::peers {

PlanarMotion planar_rest(const PlanarMotion& start, const Vector2& half, double friction) {
  constexpr int kPoints = 40;
  constexpr double kStep = 1e-4, kGravity = 9.81, kSlow = 1e-4, kAtRest = 2e-3;  // s, m/s^2, m/s, m/s
  const double inertia = half.squaredNorm() / 3.0;                               // per mass
  PlanarMotion motion = start;
  while (motion.velocity.norm() + std::abs(motion.rate) * half.norm() > kAtRest) {
    const Eigen::Rotation2Dd turn(motion.yaw);
    Vector2 force = Vector2::Zero();
    double moment = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      for (int j = 0; j < kPoints; ++j) {
        const Vector2 arm =
            turn * Vector2(half.x() * ((2 * i + 1.0) / kPoints - 1.0), half.y() * ((2 * j + 1.0) / kPoints - 1.0));
        const Vector2 slip = motion.velocity + motion.rate * Vector2(-arm.y(), arm.x());
        const Vector2 pull = -friction * kGravity / (kPoints * kPoints) * slip / (slip.norm() + kSlow);
        force += pull;
        moment += arm.x() * pull.y() - arm.y() * pull.x();
      }
    }
    motion.velocity += kStep * force;
    motion.rate += kStep * moment / inertia;
    motion.position += kStep * motion.velocity;
    motion.yaw += kStep * motion.rate;
  }
  return motion;
}

}  // namespace snug::peers
