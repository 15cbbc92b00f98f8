// Spring: wrench of the linear 6D spring-damper, and the reference motion of S5.
#include "peers/spring.hpp"

#include <algorithm>
#include <cmath>

#include "peers/engine.hpp"

namespace snug::peers {

namespace {

/// A free box. The angular velocity is in W.
struct BoxState {
  Vector3 p = Vector3::Zero();
  Quaternion quat = Quaternion::Identity();
  Twist V{};
};

struct BoxRate {
  Vector3 p, quat_vec;
  double quat_w;
  Twist V{};
};

BoxState moved(const BoxState& state, const BoxRate& rate, double dt) {
  BoxState next = state;
  next.p += dt * rate.p;
  next.quat.w() += dt * rate.quat_w;
  next.quat.vec() += dt * rate.quat_vec;
  next.quat.normalize();
  next.V.linear += dt * rate.V.linear;
  next.V.angular += dt * rate.V.angular;
  return next;
}

BoxRate average(const BoxRate& a, const BoxRate& b, const BoxRate& c, const BoxRate& d) {
  const auto mix = [](auto& x, auto& y, auto& z, auto& w) { return ((x + 2.0 * y + 2.0 * z + w) / 6.0); };
  return {
      mix(a.p, b.p, c.p, d.p),
      mix(a.quat_vec, b.quat_vec, c.quat_vec, d.quat_vec),
      mix(a.quat_w, b.quat_w, c.quat_w, d.quat_w),
      {mix(a.V.linear, b.V.linear, c.V.linear, d.V.linear), mix(a.V.angular, b.V.angular, c.V.angular, d.V.angular)}};
}

/// Newton and Euler for the held box under gravity and the spring.
BoxRate rate_of(const HeldScene& held, const BoxState& state, double time) {
  const BoxBody& box = held.scene.bodies[static_cast<std::size_t>(held.held)];
  const Pose X_WB{state.quat.toRotationMatrix(), state.p};
  const Wrench F_W = spring_wrench(held.spring, held.holder(time), X_WB, state.V);
  const Vector3 square = (2.0 * box.half).cwiseAbs2();
  const Vector3 inertia = box.mass / 12.0 * (Vector3::Constant(square.sum()) - square);
  const Vector3 w_B = X_WB.R.transpose() * state.V.angular;
  const Vector3 moment_B = X_WB.R.transpose() * F_W.torque - w_B.cross(inertia.cwiseProduct(w_B));
  const Quaternion spin = Quaternion(0, state.V.angular.x(), state.V.angular.y(), state.V.angular.z()) * state.quat;
  return {state.V.linear,
          0.5 * spin.vec(),
          0.5 * spin.w(),
          {F_W.force / box.mass + held.scene.gravity, X_WB.R * moment_B.cwiseQuotient(inertia)}};
}

}  // namespace

Vector3 spring_deflection(const Spring& spring, const HolderMotion& holder, const Pose& X_WB) {
  return holder.X_WE.R.transpose() * (X_WB * spring.p_BA - holder.X_WE.p);
}

Wrench spring_wrench(const Spring& spring, const HolderMotion& holder, const Pose& X_WB, const Twist& V_WB) {
  const Matrix3& R_WE = holder.X_WE.R;
  const Vector3 p_BA_W = X_WB.R * spring.p_BA;
  const Vector3 p_EA_W = X_WB.p + p_BA_W - holder.X_WE.p;
  const Vector3 v_EA_W = V_WB.linear + V_WB.angular.cross(p_BA_W) - holder.V_WE.linear -
                         holder.V_WE.angular.cross(p_EA_W);  // as seen from E
  const Vector3 w_EA_W = V_WB.angular - holder.V_WE.angular;
  const Vector3 turn_E = log_rotation(R_WE.transpose() * X_WB.R);
  const Vector3 force_E = -spring.stiffness.cwiseProduct(R_WE.transpose() * p_EA_W) -
                          spring.damping.cwiseProduct(R_WE.transpose() * v_EA_W);
  const Vector3 torque_E = -spring.rotational_stiffness.cwiseProduct(turn_E) -
                           spring.rotational_damping.cwiseProduct(R_WE.transpose() * w_EA_W);
  const Vector3 force_W = R_WE * force_E;
  return {force_W, R_WE * torque_E + p_BA_W.cross(force_W)};
}

double converged_peak_deflection(const HeldScene& held) {
  constexpr double kStep = 1e-4;  // s
  const BoxBody& box = held.scene.bodies[static_cast<std::size_t>(held.held)];
  BoxState state{.p = box.X_WB.p, .quat = Quaternion(box.X_WB.R)};
  double peak = 0.0;
  for (int i = 0; i < std::lround(held.end / kStep); ++i) {
    const double t = i * kStep;
    const BoxRate a = rate_of(held, state, t);
    const BoxRate b = rate_of(held, moved(state, a, kStep / 2), t + kStep / 2);
    const BoxRate c = rate_of(held, moved(state, b, kStep / 2), t + kStep / 2);
    const BoxRate d = rate_of(held, moved(state, c, kStep), t + kStep);
    state = moved(state, average(a, b, c, d), kStep);
    const Pose X_WB{state.quat.toRotationMatrix(), state.p};
    peak = std::max(peak, spring_deflection(held.spring, held.holder(t + kStep), X_WB).norm());
  }
  return peak;
}

void Engine::pull(int body, const Spring& spring, const HolderMotion& begin, const HolderMotion&) {
  apply_wrench(body, spring_wrench(spring, begin, pose(body), velocity(body)));
}

}  // namespace snug::peers
