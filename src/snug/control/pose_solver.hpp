// solve_pose: joints that put the tool where it is wanted, nearest to where they are.
#pragma once

#include "snug/robot/kinematics.hpp"

namespace snug::control {

struct PoseSolution {
  robot::JointVector q;
  double position_error = 0.0;  ///< m, what remains
  double angle_error = 0.0;     ///< rad
  int steps = 0;
  [[nodiscard]] bool is_reached(double position = 1e-6, double angle = 1e-6) const {
    return position_error <= position && angle_error <= angle;
  }
};

/// Damped Newton from q, without regard to limits: follows a path from pose to pose on the same branch, and ends as
/// near as it comes where there is no solution. Never allocates.
[[nodiscard]] PoseSolution solve_pose(const robot::ArmModel& arm, const Pose& X_WE, const robot::JointVector& q,
                                      int most_steps = 60) noexcept;

}  // namespace snug::control
