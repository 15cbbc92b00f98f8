// solve_pose: joints that put the tool where it is wanted, nearest to where they are.
#include "snug/control/pose_solver.hpp"

#include <algorithm>

#include "snug/spatial/matrix6.hpp"

namespace snug::control {
namespace {

// Below these the pose counts as met and no further step is made: a thousandth of a micrometre.
constexpr double kGoal = 1e-9;
// Damping relative to the remaining error: 0 near the goal (Newton), and small steps where no solution is near.
constexpr double kDamping = 0.1;
constexpr double kLeastDamping = 1e-14;
// rad or m in one step: beyond it the linearisation says nothing.
constexpr double kLargestStep = 0.4;

Vector6 pose_error(const Pose& X_WE, const Pose& X_WE_goal) {
  Vector6 error;
  error << X_WE_goal.p - X_WE.p, log_rotation(X_WE_goal.R * X_WE.R.transpose());
  return error;
}

}  // namespace

PoseSolution solve_pose(const robot::ArmModel& arm, const Pose& X_WE, const robot::JointVector& q,
                        int most_steps) noexcept {
  PoseSolution solution;
  solution.q = q;
  robot::ArmPose at = robot::forward(arm, solution.q);
  Vector6 error = pose_error(at.X_WE, X_WE);
  double damping = 1.0;
  for (solution.steps = 0; solution.steps < most_steps && error.norm() > kGoal; ++solution.steps) {
    const robot::Jacobian J = robot::tool_jacobian(arm, at);
    Matrix6 M = robot::gram(J);
    M.diagonal().array() += damping * kDamping * error.squaredNorm() + kLeastDamping;
    robot::JointVector step = J.transpose() * solve_symmetric(M, error);
    const double largest = step.lpNorm<Eigen::Infinity>();
    if (largest > kLargestStep) step *= kLargestStep / largest;
    const robot::JointVector tried = solution.q + step;
    const robot::ArmPose at_tried = robot::forward(arm, tried);
    const Vector6 error_tried = pose_error(at_tried.X_WE, X_WE);
    if (!(error_tried.norm() < error.norm())) {  // too bold
      damping *= 8.0;
      if (damping > 1e8) break;
      continue;
    }
    damping = std::max(1.0, damping / 4.0);
    solution.q = tried;
    at = at_tried;
    error = error_tried;
  }
  solution.position_error = error.head<3>().norm();
  solution.angle_error = error.tail<3>().norm();
  return solution;
}

}  // namespace snug::control
