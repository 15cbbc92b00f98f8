// fit_limits: each row's profile stretched to the time and the peak speed of the simulated motion.
#include "snug/motion/fitted_limits.hpp"

#include <algorithm>
#include <cmath>

namespace snug::motion {
namespace {

constexpr double kLongest = 7200.0;  ///< s
constexpr double kLeastSpeed = 1e-3,
                 kLeastAcceleration = 1e-3;  ///< m/s or rad/s, m/s^2 or rad/s^2: of what hardly moves

/// What the simulated tool did on the way to one row.
struct RowMotion {
  double duration = 0.0;    ///< s, moving
  double speed = 0.0;       ///< m/s, peak
  double turn_speed = 0.0;  ///< rad/s, peak
};

std::vector<RowMotion> simulate_rows(const PreparedProgram& plan, const Pose& X_WE_start) {
  std::vector<RowMotion> rows(plan.program.waypoints.size());
  ControllerState state = make_controller_state(X_WE_start);
  ToolState measured = state.command;
  while (static_cast<double>(state.tick_count) * plan.settings.tick < kLongest) {
    const ControllerOutput output = tick(plan, measured, state);
    if (output.finished_now) break;
    if (output.row >= 0 && output.phase == ControllerPhase::Moving) {
      RowMotion& row = rows[static_cast<std::size_t>(output.row)];
      row.duration += plan.settings.tick;
      row.speed = std::max(row.speed, output.tool.V_WE.linear.norm());
      row.turn_speed = std::max(row.turn_speed, output.tool.V_WE.angular.norm());
    }
    measured = output.tool;
  }
  return rows;
}

/// The acceleration with which `length` takes `duration` at no more than `speed`, at most `most`: by bisection, as the
/// duration falls with the acceleration.
double acceleration_for(double length, double duration, double speed, double most) {
  if (plan_fastest_profile(length, speed, most).duration >= duration) return most;
  double low = kLeastAcceleration, high = most;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (plan_fastest_profile(length, speed, middle).duration > duration ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::vector<MotionLimits> fit_limits(const PreparedProgram& plan, const Pose& X_WE_start) {
  const std::vector<RowMotion> simulated = simulate_rows(plan, X_WE_start);
  std::vector<MotionLimits> fitted = plan.row_limits;
  Pose X_WE = X_WE_start;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const Pose& goal = plan.X_WE[i];
    const LspbSegment segment(X_WE, goal, fitted[i]);
    const RowMotion& row = simulated[i];
    MotionLimits& limits = fitted[i];
    if (segment.translation().length > 0.0 && row.speed > kLeastSpeed) {
      limits.max_speed = std::min(limits.max_speed, row.speed);
      limits.max_acceleration =
          acceleration_for(segment.translation().length, row.duration, limits.max_speed, limits.max_acceleration);
    }
    if (segment.rotation().length > 0.0 && row.turn_speed > kLeastSpeed) {
      limits.max_turn_speed = std::min(limits.max_turn_speed, row.turn_speed);
      limits.max_turn_acceleration = acceleration_for(segment.rotation().length, row.duration, limits.max_turn_speed,
                                                      limits.max_turn_acceleration);
    }
    X_WE = goal;
  }
  return fitted;
}

}  // namespace snug::motion
