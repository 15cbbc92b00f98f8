// Free turning: Euler's equations of one body over a step.
#include "snug/physics/internal/free_turning.hpp"

#include <optional>

namespace snug::physics::internal {
namespace {

/// A body that turns.
struct Spin {
  Matrix3 R_WI;     ///< principal axes
  Vector3 angular;  ///< rad/s, W
};

/// Euler's equations by the implicit midpoint rule; keeps energy and angular momentum where the impulse of the torque
/// [N m s, W, at the middle of the step] is zero. False where the step is too long for its iteration.
bool turn(const WorldModel::MassProperties& mass, const Vector3& torque_W, double dt, Spin& spin) {
  const Vector3 inertia = mass.inverse_inertia.cwiseInverse();
  const Vector3 w0 = spin.R_WI.transpose() * spin.angular;
  const bool is_pushed = !torque_W.isZero(0.0);
  const Matrix3 R_WI_mid = is_pushed ? Matrix3(exp_rotation(0.5 * dt * spin.angular) * spin.R_WI) : spin.R_WI;
  const Vector3 push =
      is_pushed ? Vector3(mass.inverse_inertia.cwiseProduct(R_WI_mid.transpose() * torque_W)) : Vector3::Zero();
  Vector3 w1 = w0;
  double change = 0.0;
  for (int k = 0; k < 20; ++k) {
    const Vector3 mid = 0.5 * (w0 + w1);
    Vector3 next = w0 - dt * mass.inverse_inertia.cwiseProduct(mid.cross(inertia.cwiseProduct(mid)));
    if (is_pushed) next += push;
    change = (next - w1).norm();
    w1 = next;
    if (change <= 1e-14 * (1.0 + w0.norm())) break;
  }
  if (!(change <= 1e-9 * (1.0 + w0.norm()))) return false;
  const Matrix3 turned = exp_rotation(0.5 * dt * (w0 + w1));
  spin = {spin.R_WI * turned, spin.R_WI * (turned * w1)};
  return true;
}

/// The angular velocity w at the end of a step that turns the body by dt/2 (w_0 + w), if it is `angular_I` in the
/// body's axes then: keeps the energy that `turn` keeps. None where the step is too long for its iteration.
std::optional<Vector3> carry_along(const Matrix3& R_WI, const Vector3& angular_start, const Vector3& angular_I,
                                   double dt, const Vector3& guess) {
  const Vector3 from_start = R_WI * angular_I;
  Vector3 angular = guess;
  for (int k = 0; k < 50; ++k) {
    const Vector3 next = exp_rotation(0.5 * dt * (angular_start + angular)) * from_start;
    const double change = (next - angular).norm();
    angular = next;
    if (change <= 1e-9 * (1.0 + angular_start.norm())) return angular;
  }
  return std::nullopt;
}

}  // namespace

Vector3 turn_freely(const WorldModel::MassProperties& mass, const BodyWork& body, const Vector3& torque_W, double dt) {
  constexpr int kMaxParts = 1024;
  constexpr double kLongTurn = 0.1;  // rad in a step
  const Matrix3 R_WI = body.R_WB * mass.R_BI;
  for (int parts = 1; parts <= kMaxParts; parts *= 2) {
    Spin spin{R_WI, body.angular_start};
    int done = 0;
    while (done < parts && turn(mass, torque_W / parts, dt / parts, spin)) ++done;
    if (done < parts) continue;
    if (dt * body.angular_start.norm() <= kLongTurn) return spin.angular;
    return carry_along(R_WI, body.angular_start, spin.R_WI.transpose() * spin.angular, dt, spin.angular)
        .value_or(spin.angular);
  }
  return body.angular_start;
}

}  // namespace snug::physics::internal
