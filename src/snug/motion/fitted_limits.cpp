// fit_limits: each row's profile stretched to the time of the simulated motion, at its peak speed where that suffices.
#include "snug/motion/fitted_limits.hpp"

#include <algorithm>
#include <cmath>

namespace snug::motion {
namespace {

constexpr double kLongest = 7200.0;          ///< s
constexpr double kLeastSpeed = 1e-3;         ///< m/s or rad/s, of what hardly moves
constexpr double kLeastAcceleration = 1e-3;  ///< m/s^2 or rad/s^2, likewise
constexpr int kHalvings = 60;                ///< of an interval; more than a double has bits

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

/// Of a profile's speed and acceleration.
struct ProfileLimits {
  double speed = 0.0, acceleration = 0.0;
};

/// The value at which `duration_at` that value, falling, is `duration`, no shorter than that by rounding.
template <class DurationAt>
double bisect(double low, double high, double duration, DurationAt duration_at) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (duration_at(middle) > duration ? low : high) = middle;
  }
  return high;
}

/// With which `length` takes `duration`, no faster than the simulated `peak` where that suffices; never above `most`.
/// What takes no longer with `most` keeps them: a row that is passed at once, since it lies within its precision, has
/// neither a duration nor a speed that say how to go all of its way.
ProfileLimits fit_profile(double length, double duration, double peak, const ProfileLimits& most) {
  if (plan_fastest_profile(length, most.speed, most.acceleration).duration >= duration) return most;
  ProfileLimits fitted{std::min(most.speed, std::max(peak, kLeastSpeed)), most.acceleration};
  if (plan_fastest_profile(length, fitted.speed, most.acceleration).duration > duration) {  // it was left on the way
    fitted.speed = bisect(fitted.speed, most.speed, duration, [&](double speed) {
      return plan_fastest_profile(length, speed, most.acceleration).duration;
    });
    return fitted;
  }
  fitted.acceleration = bisect(kLeastAcceleration, most.acceleration, duration, [&](double acceleration) {
    return plan_fastest_profile(length, fitted.speed, acceleration).duration;
  });
  return fitted;
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
    if (segment.translation().length > 0.0) {
      const ProfileLimits fit = fit_profile(segment.translation().length, row.duration, row.speed,
                                            {limits.max_speed, limits.max_acceleration});
      limits.max_speed = fit.speed;
      limits.max_acceleration = fit.acceleration;
    }
    if (segment.rotation().length > 0.0) {
      const ProfileLimits fit = fit_profile(segment.rotation().length, row.duration, row.turn_speed,
                                            {limits.max_turn_speed, limits.max_turn_acceleration});
      limits.max_turn_speed = fit.speed;
      limits.max_turn_acceleration = fit.acceleration;
    }
    X_WE = goal;
  }
  return fitted;
}

}  // namespace snug::motion
