// ToolState: pose and velocity of the tool, and the smooth path between two of them one controller tick apart.
#include "snug/motion/tool_path.hpp"

#include <algorithm>
#include <cmath>

namespace snug::motion {
namespace {

/// J with w = J(phi) phi', where w is the velocity, in the fixed frame, of R = exp(phi): J = I + b S + c S^2, S =
/// skew(phi).
struct ExpJacobian {
  double b = 0.5;
  double c = 1.0 / 6.0;
};

ExpJacobian exp_jacobian(double angle) {
  // Series below 1e-2: the first dropped terms, angle^6 / 40320 and / 362880, are below 1e-16.
  const double x = angle * angle;
  if (angle < 1e-2) return {0.5 - x / 24.0 + x * x / 720.0, 1.0 / 6.0 - x / 120.0 + x * x / 5040.0};
  return {(1.0 - std::cos(angle)) / x, (angle - std::sin(angle)) / (x * angle)};
}

Vector3 apply_jacobian(const Vector3& phi, const Vector3& rate) {
  const auto [b, c] = exp_jacobian(phi.norm());
  const Vector3 turned = phi.cross(rate);
  return rate + b * turned + c * phi.cross(turned);
}

/// phi' with J(phi) phi' = w.
Vector3 solve_jacobian(const Vector3& phi, const Vector3& w) {
  const double angle = phi.norm();
  // (1 - (x/2) cot(x/2)) / x^2 by its series below 1e-2: the dropped term x^4 / 30240 is below 1e-12 of the sum.
  const double x = angle * angle;
  const double half = 0.5 * angle;
  const double e = angle < 1e-2 ? 1.0 / 12.0 + x / 720.0 + x * x / 30240.0 : (1.0 - half / std::tan(half)) / x;
  const Vector3 turned = phi.cross(w);
  return w - 0.5 * turned + e * phi.cross(turned);
}

/// Cubic Hermite from 0 to x1 over `duration`, with end rates v0 and v1.
struct Hermite {
  Vector3 value;
  Vector3 rate;
};

Hermite hermite_from_zero(const Vector3& v0, const Vector3& x1, const Vector3& v1, double duration, double s) {
  const double s2 = s * s;
  const double s3 = s2 * s;
  Hermite h;
  h.value = (s3 - 2.0 * s2 + s) * duration * v0 + (3.0 * s2 - 2.0 * s3) * x1 + (s3 - s2) * duration * v1;
  h.rate = (3.0 * s2 - 4.0 * s + 1.0) * v0 + (6.0 * (s - s2) / duration) * x1 + (3.0 * s2 - 2.0 * s) * v1;
  return h;
}

}  // namespace

ToolState interpolate(const ToolState& start, const ToolState& end, double duration, double fraction) noexcept {
  if (!(fraction > 0.0)) return start;
  if (fraction >= 1.0) return end;
  const Hermite line =
      hermite_from_zero(start.V_WE.linear, end.X_WE.p - start.X_WE.p, end.V_WE.linear, duration, fraction);
  const Vector3 turn_W = log_rotation(end.X_WE.R * start.X_WE.R.transpose());
  const Hermite turn =
      hermite_from_zero(start.V_WE.angular, turn_W, solve_jacobian(turn_W, end.V_WE.angular), duration, fraction);
  ToolState state;
  state.X_WE = {exp_rotation(turn.value) * start.X_WE.R, start.X_WE.p + line.value};
  state.V_WE = {line.rate, apply_jacobian(turn.value, turn.rate)};
  return state;
}

}  // namespace snug::motion
