// settle: where a load comes to rest under a held cup, found without simulating.
#include "snug/cup/statics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/cup/potential_law.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::cup {
namespace {

constexpr double kPerLength = 20.0;  // 1/m, makes torques comparable with forces: a lever of 50 mm, the cup's length
constexpr double kMaxShift = 0.05;   // m, of one Newton step: again the cup's length
constexpr double kMaxStride = 0.5;   // rad, between two load steps; a larger one has jumped to another branch
constexpr double kSmallestPart = 1.0 / 4096.0;  // of a load step
constexpr double kNearFold = 0.1;  // of the unloaded stiffness; a fold at 1/4096 of a load step leaves about 0.01
constexpr int kMaxHalvings = 10;
constexpr double kLargestBend = std::numbers::pi / 4.0;  // where the law's moment is at its maximum

Vector6 row_scale() {
  Vector6 scale;
  scale << 1.0, 1.0, 1.0, kPerLength, kPerLength, kPerLength;
  return scale;
}

/// The balance at S1: spring wrench plus a fraction of gravity's, and its derivative by the body twist of S1.
class Balance {
 public:
  explicit Balance(const HeldLoad& load)
      : K_(load.stiffness),
        law_(load.law),
        weight_S2_(load.mass * ((load.R_WE * load.X_ES2.R).transpose() * load.gravity_W)),
        p_S1Scm_(load.X_SS1.inverse() * load.p_SScm) {}

  [[nodiscard]] Vector6 wrench(const Pose& H, double fraction) const {
    const Vector3 weight = fraction * (H.R.transpose() * weight_S2_);
    Vector6 gravity;
    gravity << weight, p_S1Scm_.cross(weight);
    return spring_wrench(H, K_, law_) + gravity;
  }

  [[nodiscard]] Matrix6 tangent(const Pose& H, double fraction) const {
    const Matrix3 turn = skew(fraction * (H.R.transpose() * weight_S2_));
    Matrix6 T = spring_tangent(H, K_, law_);
    T.topRightCorner<3, 3>() += turn;
    T.bottomRightCorner<3, 3>() += skew(p_S1Scm_) * turn;
    return T;
  }

  /// Below this the scaled residual is as good as zero, N.
  [[nodiscard]] double tolerance(double relative) const {
    // Rounding of the deformation, 16 epsilon of 50 mm and of 1 rad, times the stiffness.
    const Matrix6 stiffness = row_scale().asDiagonal() * K_ * (row_scale() / kPerLength).asDiagonal();
    const double load = weight_S2_.norm() + kPerLength * p_S1Scm_.cross(weight_S2_).norm();
    return relative * load + 16.0 * std::numeric_limits<double>::epsilon() * stiffness.norm();
  }

 private:
  Matrix6 K_;
  model::CupLaw law_;
  Vector3 weight_S2_;
  Vector3 p_S1Scm_;
};

double scaled_norm(const Vector6& wrench) { return row_scale().cwiseProduct(wrench).norm(); }

Pose moved(const Pose& H, const Vector6& nu) {
  return {orthonormalized(H.R * exp_rotation(nu.tail<3>())), H.p + H.R * nu.head<3>()};
}

double smallest_eigenvalue(const Matrix6& stiffness) {
  const Matrix6 symmetric = 0.5 * (stiffness + stiffness.transpose());
  return symmetric_eigenvalues(symmetric)[0];
}

/// Of the tangent stiffness, with rotations measured by their arc at the cup's length: N/m.
double smallest_scaled(const Matrix6& tangent) {
  return smallest_eigenvalue(-(row_scale().asDiagonal() * tangent * row_scale().asDiagonal()));
}

bool is_usable(const HeldLoad& load) {
  const bool is_finite = load.R_WE.allFinite() && std::isfinite(load.mass) && load.p_SScm.allFinite() &&
                         load.stiffness.allFinite() && load.X_ES2.R.allFinite() && load.X_ES2.p.allFinite() &&
                         load.X_SS1.R.allFinite() && load.X_SS1.p.allFinite() && load.gravity_W.allFinite();
  return is_finite && load.mass >= 0.0 && is_positive_definite(load.stiffness);
}

struct NewtonResult {
  bool has_converged = false;
  Pose H;
};

/// Newton's method for one fraction of gravity; counts into `iterations`.
NewtonResult solve(const Balance& balance, const Pose& start, double fraction, const SettleOptions& options,
                   double tolerance, int& iterations) {
  Pose H = start;
  Vector6 wrench = balance.wrench(H, fraction);
  double error = scaled_norm(wrench);
  for (int i = 0; i < options.max_iterations && error > tolerance; ++i) {
    ++iterations;
    Vector6 dx = -snug::solve(balance.tangent(H, fraction), wrench);
    if (!dx.allFinite()) return {false, H};
    dx *= std::min({1.0, options.max_turn / std::max(dx.tail<3>().norm(), 1e-300),
                    kMaxShift / std::max(dx.head<3>().norm(), 1e-300)});
    double best = std::numeric_limits<double>::infinity();
    for (int halving = 0; halving <= kMaxHalvings; ++halving, dx *= 0.5) {
      const Pose trial = moved(H, dx);
      const Vector6 trial_wrench = balance.wrench(trial, fraction);
      best = scaled_norm(trial_wrench);
      if (best < error) {
        H = trial;
        wrench = trial_wrench;
        break;
      }
    }
    if (!(best < error)) return {false, H};  // no way down: a fold, or a stop at rounding
    error = best;
  }
  return {error <= tolerance, H};
}

/// Follows the equilibrium from the undeformed cup while gravity grows; see SettleStatus for how it may end.
SettleStatus follow_branch(const Balance& balance, const SettleOptions& options, SettleResult& result) {
  const double tolerance = balance.tolerance(options.tolerance);
  const double whole = 1.0 / std::max(1, options.load_steps);
  const double unloaded = smallest_scaled(balance.tangent(Pose{}, 0.0));
  double part = whole, stiffness = unloaded;
  while (result.load_fraction < 1.0) {
    const double fraction = std::min(1.0, result.load_fraction + part);
    const NewtonResult next = solve(balance, result.H, fraction, options, tolerance, result.iterations);
    const bool is_near = next.has_converged && angle_between(result.H.R, next.H.R) < kMaxStride;
    const double next_stiffness = is_near ? smallest_scaled(balance.tangent(next.H, fraction)) : 0.0;
    const bool is_smallest = part <= whole * kSmallestPart;
    // Stability lost in one step: either over a fold onto the branch that comes back (then a shorter step stays on
    // ours), or where a symmetric equilibrium goes on unstably: that one is real, and is found with the shortest step.
    const bool has_tipped = stiffness > 0.0 && next_stiffness <= 0.0;
    if (is_near && (!has_tipped || is_smallest)) {
      result.H = next.H;
      result.load_fraction = fraction;
      stiffness = next_stiffness;
      part = std::min(whole, 2.0 * part);
      continue;
    }
    if (is_smallest) {
      return std::abs(stiffness) < kNearFold * unloaded ? SettleStatus::BeyondCapacity : SettleStatus::NotConverged;
    }
    part *= 0.5;
  }
  return SettleStatus::Converged;
}

}  // namespace

const char* name_of(SettleStatus status) {
  switch (status) {
    case SettleStatus::Converged:
      return "converged";
    case SettleStatus::BeyondCapacity:
      return "beyond_capacity";
    case SettleStatus::NotConverged:
      return "not_converged";
    case SettleStatus::BadInput:
      return "bad_input";
  }
  return "";
}

SettleResult settle(const HeldLoad& load, const SettleOptions& options) {
  SettleResult result;
  if (!is_usable(load)) {
    result.status = SettleStatus::BadInput;
    return result;
  }
  const Balance balance(load);
  result.status = follow_branch(balance, options, result);
  result.bend = bend_angle(result.H.R);
  // Gravity alone can hold a load that has swung below the gripper, but no cup is bent like that.
  if (result.bend >= kLargestBend) result.status = SettleStatus::BeyondCapacity;
  result.X_ES = load.X_ES2 * result.H * load.X_SS1.inverse();
  result.residual = scaled_norm(balance.wrench(result.H, 1.0));
  const Matrix6 X = wrench_transform(load.X_SS1);
  result.smallest_eigenvalue =
      smallest_eigenvalue(-(X * balance.tangent(result.H, result.load_fraction) * X.transpose()));
  result.is_stable = result.status == SettleStatus::Converged && result.smallest_eigenvalue > 0.0;
  return result;
}

}  // namespace snug::cup
