// InverseKinematics: branches refined to the exact arm, the nearest within limits, and the search without closed form.
#include "snug/robot/inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::robot {
namespace {

/// The ideal arm may be out of reach where the exact one is not, by what a calibration changes.
constexpr double kReachSlack = 0.020;  // m
constexpr int kNewtonSteps = 20;
constexpr int kSearchSteps = 200;
constexpr int kSearchStarts = 40;

/// From where the tool is to where it should be: metres and radians, in W.
Vector6 pose_error(const Pose& X_WE, const Pose& X_WT) noexcept {
  Vector6 error;
  error.head<3>() = X_WT.p - X_WE.p;
  const Matrix3 R = X_WT.R * X_WE.R.transpose();
  const Vector3 sine = 0.5 * Vector3(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  // Within 0.05 rad the sine serves: Newton steps lose nothing by an error of third order.
  if (R.trace() > 2.9975)
    error.tail<3>() = sine;
  else
    error.tail<3>() = log_rotation(R);
  return error;
}

/// min |J dq - error|^2 + damping^2 |dq|^2
JointVector damped_step(const Jacobian& J, const Vector6& error, double damping) noexcept {
  Matrix6 M = gram(J);
  M.diagonal().array() += damping * damping;
  const Vector6 y = solve_symmetric(M, error);
  return J.transpose() * y;
}

JointVector newton_step(const Jacobian& J, const Vector6& error) noexcept {
  if (J.cols() != 6) return damped_step(J, error, 1e-9);
  JointVector step = solve(Matrix6(J), error);
  // Near a singularity the plain step leaves the neighbourhood in which the linear model holds.
  if (!(step.cwiseAbs().maxCoeff() < 0.3)) step = damped_step(J, error, 0.02);
  return step;
}

void wrap_turns(const ArmModel& arm, JointVector& q) noexcept {
  const double turn = 2.0 * std::numbers::pi;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (arm.joints[static_cast<std::size_t>(i)].kind != JointKind::Revolute) continue;
    q(i) -= turn * std::round(q(i) / turn);
    if (q(i) <= -std::numbers::pi) q(i) += turn;
  }
}

/// Moves each turning joint by full turns to the value within its limits that is nearest to q_near; false when a
/// joint has none.
bool fit_turns(const ArmModel& arm, const JointVector& q_near, JointVector& q) noexcept {
  const double turn = 2.0 * std::numbers::pi;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    // 1e-9 rad: a branch exactly on a limit stays one, in spite of rounding.
    const auto is_within = [&](double value) { return value >= joint.lower - 1e-9 && value <= joint.upper + 1e-9; };
    if (joint.kind == JointKind::Revolute) {
      const double nearest = q(i) + turn * std::round((q_near(i) - q(i)) / turn);
      double best = std::numeric_limits<double>::infinity();
      for (int k = -3; k <= 3; ++k) {
        const double value = nearest + k * turn;
        if (is_within(value) && std::abs(value - q_near(i)) < std::abs(best - q_near(i))) best = value;
      }
      if (!std::isfinite(best)) return false;
      q(i) = std::clamp(best, joint.lower, joint.upper);
    } else if (!is_within(q(i))) {
      return false;
    }
  }
  return true;
}

/// Elbow and fifth joint at least 0.15 rad from where their branches meet, each on its side.
JointVector spread(JointVector q) noexcept {
  for (const Eigen::Index i : {2, 4}) {
    const double middle = std::numbers::pi * std::round(q(i) / std::numbers::pi);
    const double side = q(i) - middle;
    if (std::abs(side) < 0.15) q(i) = middle + std::copysign(0.15, side);
  }
  return q;
}

bool is_known(const IkBranches& found, const JointVector& q) noexcept {
  for (int i = 0; i < found.count; ++i)
    if ((found.q[static_cast<std::size_t>(i)] - q).cwiseAbs().maxCoeff() < 1e-6) return true;
  return false;
}

JointVector random_start(const ArmModel& arm, Rng& rng) noexcept {
  JointVector q(arm.joint_count());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double lower = std::max(joint.lower, -std::numbers::pi);
    const double upper = std::min(joint.upper, std::numbers::pi);
    q(i) = lower < upper ? rng.uniform(lower, upper) : 0.5 * (joint.lower + joint.upper);
  }
  return q;
}

}  // namespace

std::string_view describe(NoReach reason) noexcept {
  switch (reason) {
    case NoReach::OutOfReach:
      return "out of reach";
    case NoReach::BeyondLimits:
      return "beyond the joint limits";
    case NoReach::NotConverged:
      return "not found by the search";
  }
  return "";
}

InverseKinematics::InverseKinematics(const ArmModel& arm) : arm_(arm), ur_(find_ur_geometry(arm)) {
  if (!ur_) wrist_ = find_wrist_geometry(arm);
}

std::optional<JointVector> InverseKinematics::refine(const Pose& X_WE, const JointVector& q_start) const noexcept {
  JointVector q = q_start;
  ArmPose at = forward(arm_, q);
  Vector6 error = pose_error(at.X_WE, X_WE);
  // One step beyond the tolerance costs little and squares the error; a start that is exact takes none.
  bool is_last = error.norm() <= 1e-12;
  for (int k = 0; k < kNewtonSteps && !is_last; ++k) {
    is_last = error.norm() <= 1e-7;
    q += newton_step(tool_jacobian(arm_, at), error);
    if (!q.allFinite()) return std::nullopt;
    at = forward(arm_, q);
    error = pose_error(at.X_WE, X_WE);
  }
  if (!(error.head<3>().norm() <= kIkTolerance && error.tail<3>().norm() <= kIkTolerance)) return std::nullopt;
  return q;
}

IkBranches InverseKinematics::branches(const Pose& X_WE, const JointVector& q_near) const noexcept {
  if (!has_closed_form()) return search(X_WE, q_near);
  IkBranches found;
  const Pose X_BE = arm_.X_WB.inverse() * X_WE;
  const ClosedBranches ideal =
      ur_ ? solve_ur(*ur_, X_BE, q_near(5), kReachSlack) : solve_wrist_arm(*wrist_, X_BE, q_near(5), kReachSlack);
  found.shortfall = ideal.shortfall;
  for (int i = 0; i < ideal.count; ++i) {
    const auto& values = ideal.q[static_cast<std::size_t>(i)];
    const JointVector start = Eigen::Map<const Vector6>(values.data());
    // Near a singularity two branches may run to the same one: start again a little farther from where they meet.
    if (!add_branch(X_WE, start, found)) (void)add_branch(X_WE, spread(start), found);
  }
  if (found.count > 0) found.shortfall = std::min(found.shortfall, 0.0);
  return found;
}

bool InverseKinematics::add_branch(const Pose& X_WE, const JointVector& start, IkBranches& found) const noexcept {
  if (found.count == static_cast<int>(found.q.size())) return false;
  const std::optional<JointVector> exact = refine(X_WE, start);
  if (!exact) return false;
  JointVector q = *exact;
  wrap_turns(arm_, q);
  if (is_known(found, q)) return false;
  found.q[static_cast<std::size_t>(found.count++)] = q;
  return true;
}

std::optional<JointVector> InverseKinematics::search_from(const Pose& X_WE, const JointVector& q_start) const noexcept {
  JointVector q = q_start;
  for (int k = 0; k < kSearchSteps; ++k) {
    const ArmPose at = forward(arm_, q);
    const Vector6 error = pose_error(at.X_WE, X_WE);
    const double size = error.norm();
    if (size < 1e-4) break;
    JointVector step = damped_step(tool_jacobian(arm_, at), error, std::min(0.1, 0.1 * size));
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 0.5) step *= 0.5 / longest;
    q += step;
    // Within the limits all the time, so that what is found can be used.
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Joint& joint = arm_.joints[static_cast<std::size_t>(i)];
      q(i) = std::clamp(q(i), joint.lower, joint.upper);
    }
  }
  return refine(X_WE, q);
}

IkBranches InverseKinematics::search(const Pose& X_WE, const JointVector& q_near) const noexcept {
  IkBranches found;
  Rng rng = Rng(1).split("inverse kinematics");
  for (int s = 0; s < kSearchStarts && found.count < 8; ++s) {
    std::optional<JointVector> q = search_from(X_WE, s == 0 ? q_near : random_start(arm_, rng));
    if (!q || !fit_turns(arm_, q_near, *q) || is_known(found, *q)) continue;
    found.q[static_cast<std::size_t>(found.count++)] = *q;
  }
  return found;
}

Expected<JointVector, NoReach> InverseKinematics::nearest(const Pose& X_WE, const JointVector& q_near) const noexcept {
  if (!has_closed_form()) {
    std::optional<JointVector> q = search_from(X_WE, q_near);
    if (q && fit_turns(arm_, q_near, *q)) return *q;
  }
  IkBranches found = branches(X_WE, q_near);
  // Following a path, the joints before are the best start there is.
  if (has_closed_form() && found.count > 0) (void)add_branch(X_WE, q_near, found);
  if (found.count == 0) return Unexpected<NoReach>(has_closed_form() ? NoReach::OutOfReach : NoReach::NotConverged);
  std::optional<JointVector> best;
  for (int i = 0; i < found.count; ++i) {
    JointVector q = found.q[static_cast<std::size_t>(i)];
    if (!fit_turns(arm_, q_near, q)) continue;
    if (!best || (q - q_near).squaredNorm() < (*best - q_near).squaredNorm()) best = q;
  }
  if (!best) return Unexpected<NoReach>(NoReach::BeyondLimits);
  return *best;
}

}  // namespace snug::robot
