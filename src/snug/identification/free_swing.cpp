// FreeSwing: rigid-body dynamics at S1, and their variational equations.
#include "snug/identification/free_swing.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/law.hpp"
#include "snug/identification/internal/pose_misfit.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification {
namespace {

constexpr double kStepTimesRate = 0.25;  // of the fastest mode: RK4 changes its amplitude by (1/4)^6 / 144 a step
constexpr int kMostColumns = 22;         // 5 + 5 + 6 + 6
using Columns = Eigen::Matrix<double, 12, Eigen::Dynamic, 0, 12, kMostColumns>;

/// The state and its derivatives: rows 0-5 the body twist that moves H, rows 6-11 the change of the velocity.
struct State {
  Matrix3 R;
  Vector3 o;
  Vector6 nu;
  Columns S;
};

class Dynamics {
 public:
  Dynamics(const FreeSwing& swing, const SwingDirections& directions) : swing_(swing), directions_(directions) {
    const Vector3 c = swing.frames.X_SS1.inverse() * swing.load_S.com;
    const Matrix3 R = swing.frames.X_SS1.R;
    const double m = swing.load_S.mass;
    M_ << m * Matrix3::Identity(), -m * skew(c), m * skew(c),
        R.transpose() * swing.load_S.inertia * R - m * skew(c) * skew(c);
    M_inverse_ = inverse(M_);
    gravity_.is_gravity = true;
    gravity_.weight_S2 = m * ((swing.R_WE * swing.frames.X_ES2.R).transpose() * swing.gravity_W);
    gravity_.p_S1Scm = c;
  }

  /// 1/s, of the fastest mode or decay.
  [[nodiscard]] double fastest_rate() const {
    return std::max(std::sqrt(spectral_radius(swing_.K, M_)), spectral_radius(swing_.D, M_));
  }

  [[nodiscard]] State rate(const State& at) const {
    const Pose H{at.R, at.o};
    const Vector3 v = at.nu.head<3>(), w = at.nu.tail<3>();
    const Vector6 momentum = M_ * at.nu;
    const Vector3 p = momentum.head<3>(), l = momentum.tail<3>();
    const Vector6 turning = (Vector6() << w.cross(p), w.cross(l) + v.cross(p)).finished();
    const Vector6 force = cup::spring_wrench(H, swing_.K) - gravity_.wanted(H) - swing_.D * at.nu - turning;
    State rate{at.R * skew(w), at.R * v, M_inverse_ * force, Columns(12, at.S.cols())};
    if (at.S.cols() == 0) return rate;
    Matrix6 ad, change;  // of the twist along itself; of `turning` by the velocity
    ad << skew(w), skew(v), Matrix3::Zero(), skew(w);
    change << Matrix3::Zero(), -skew(p), -skew(p), -skew(l);
    change += -ad.transpose() * M_;
    const Matrix6 by_pose = M_inverse_ * (cup::spring_tangent(H, swing_.K) - gravity_.wanted_tangent(H));
    const Matrix6 by_velocity = -M_inverse_ * (swing_.D + change);
    rate.S.topRows<6>().noalias() = at.S.bottomRows<6>() - ad * at.S.topRows<6>();
    rate.S.bottomRows<6>().noalias() = by_pose * at.S.topRows<6>() + by_velocity * at.S.bottomRows<6>();
    Eigen::Index column = 0;
    for (const Matrix6& basis : directions_.damping) rate.S.col(column++).tail<6>() -= M_inverse_ * (basis * at.nu);
    for (const Matrix6& basis : directions_.stiffness)
      rate.S.col(column++).tail<6>() += M_inverse_ * cup::spring_wrench(H, basis);
    return rate;
  }

 private:
  const FreeSwing& swing_;
  const SwingDirections& directions_;
  Matrix6 M_, M_inverse_;
  internal::Balance gravity_;
};

State plus(const State& at, double h, const State& rate) {
  return {at.R + h * rate.R, at.o + h * rate.o, at.nu + h * rate.nu, at.S + h * rate.S};
}

void step(const Dynamics& dynamics, double h, State& state) {
  const State k1 = dynamics.rate(state);
  const State k2 = dynamics.rate(plus(state, 0.5 * h, k1));
  const State k3 = dynamics.rate(plus(state, 0.5 * h, k2));
  const State k4 = dynamics.rate(plus(state, h, k3));
  state.R = orthonormalized(state.R + h / 6.0 * (k1.R + 2.0 * k2.R + 2.0 * k3.R + k4.R));
  state.o += h / 6.0 * (k1.o + 2.0 * k2.o + 2.0 * k3.o + k4.o);
  state.nu += h / 6.0 * (k1.nu + 2.0 * k2.nu + 2.0 * k3.nu + k4.nu);
  state.S += h / 6.0 * (k1.S + 2.0 * k2.S + 2.0 * k3.S + k4.S);
}

}  // namespace

Eigen::Index SwingDirections::count() const {
  return static_cast<Eigen::Index>(damping.size() + stiffness.size()) + (by_start ? 6 : 0) + (by_velocity ? 6 : 0);
}

std::vector<SwingSample> simulate_swing(const FreeSwing& swing, const Pose& X_ES, const Vector6& twist_S1,
                                        const std::vector<double>& times, const SwingDirections& directions) {
  const Dynamics dynamics(swing, directions);
  const double longest = kStepTimesRate / std::max(1e-3, dynamics.fastest_rate());
  const Matrix6 to_S = inverse(cup::wrench_transform(swing.frames.X_SS1).transpose());  // twist of S1 to that of S
  const Pose X_S1S = swing.frames.X_SS1.inverse();
  const Pose H = swing.frames.X_ES2.inverse() * X_ES * swing.frames.X_SS1;
  State state{H.R, H.p, twist_S1, Columns::Zero(12, directions.count())};
  Eigen::Index column = static_cast<Eigen::Index>(directions.damping.size() + directions.stiffness.size());
  if (directions.by_start) state.S.block<6, 6>(0, column).setIdentity();
  if (directions.by_start) column += 6;
  if (directions.by_velocity) state.S.block<6, 6>(6, column).setIdentity();
  std::vector<SwingSample> samples;
  samples.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0) {
      const double span = times[i] - times[i - 1];
      const int steps = std::max(1, static_cast<int>(std::ceil(span / longest)));
      for (int k = 0; k < steps; ++k) step(dynamics, span / steps, state);
    }
    samples.push_back({swing.frames.X_ES2 * Pose{state.R, state.o} * X_S1S, state.nu, to_S * state.S.topRows<6>()});
  }
  return samples;
}

}  // namespace snug::identification
