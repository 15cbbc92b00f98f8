// Controller: runs a Program on the tool frame, one tick at a time: as the demonstrator did, or as it should have.
#include "snug/motion/controller.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/fast_controller.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

void require(bool ok, const Program& program, const char* key, double got, const char* expected) {
  if (!ok) throw InputError(program.name, key, fmt::format("{}", got), expected);
}

/// Ticks that pass until `time` is over; exact multiples are not rounded up.
std::int64_t ticks_of(double time, double tick) { return static_cast<std::int64_t>(std::ceil(time / tick - 1e-9)); }

void begin_motion(const PreparedProgram& plan, ControllerState& state) {
  const std::size_t row = static_cast<std::size_t>(state.row);
  state.phase = ControllerPhase::Moving;
  state.phase_ticks = 0;
  state.segment = LspbSegment(state.X_WE_departure, plan.X_WE[row], plan.row_limits[row]);
  if (is_lagged(plan.settings.tracking) && plan.settings.sampled_coast) {
    state.segment = state.segment.with_sampled_coast(plan.settings.tick);
  }
}

/// The row's switches act now; the motion to it begins now or, after a change of the vacuum, later.
void depart(const PreparedProgram& plan, int row, const Pose& X_WE, ControllerState& state) {
  const IO& io = plan.program.waypoints[static_cast<std::size_t>(row)].io;
  const bool waits = io.vacuum != state.io.vacuum || (io.blow_off && !state.io.blow_off);
  state.row = row;
  state.io = io;
  state.X_WE_departure = X_WE;
  state.phase_ticks = 0;
  if (waits && plan.settings.vacuum_wait > 0.0) {
    state.phase = ControllerPhase::Waiting;
  } else {
    begin_motion(plan, state);
  }
}

bool has_reached_row(const PreparedProgram& plan, const ToolState& measured, const ControllerState& state) {
  const std::size_t row = static_cast<std::size_t>(state.row);
  if (is_fast(plan.settings.tracking)) return has_reached_fast(plan, measured, state);
  if (is_exact(plan.settings.tracking)) {
    return static_cast<double>(state.phase_ticks) * plan.settings.tick >= state.segment.duration();
  }
  return convergence_error(measured.X_WE, plan.X_WE[row], plan.settings.convergence_deg_per_metre) <=
         plan.row_limits[row].precision;
}

/// What the program does at the start of a tick: starts, waits, goes on to the next row, ends.
void advance_program(const PreparedProgram& plan, const ToolState& measured, ControllerState& state,
                     ControllerOutput& output) {
  const bool follows_exactly = is_exact(plan.settings.tracking);
  const Pose& X_WE = follows_exactly ? state.command.X_WE : measured.X_WE;
  if (state.phase == ControllerPhase::Ready) {
    depart(plan, 0, X_WE, state);
    output.departed = 0;
  } else if (state.phase == ControllerPhase::Waiting) {
    if (state.phase_ticks >= ticks_of(plan.settings.vacuum_wait, plan.settings.tick)) begin_motion(plan, state);
  } else if (state.phase == ControllerPhase::Moving && has_reached_row(plan, measured, state)) {
    output.reached = state.row;
    const bool is_last = state.row + 1 == static_cast<int>(plan.program.waypoints.size());
    if (is_last || is_too_early(plan, state, state.row + 1)) {
      state.phase = is_last ? ControllerPhase::Finished : ControllerPhase::Standing;
      state.phase_ticks = 0;
      state.X_WE_reference = plan.X_WE[static_cast<std::size_t>(state.row)];
      output.finished_now = is_last;
    } else {
      depart(plan, state.row + 1, X_WE, state);
      output.departed = state.row;
    }
  } else if (state.phase == ControllerPhase::Standing && !is_too_early(plan, state, state.row + 1)) {
    depart(plan, state.row + 1, measured.X_WE, state);  // as a motion that is sent by itself
    output.departed = state.row;
  }
}

/// Constant acceleration over one tick toward the reference: k err - 2 sqrt(k) V, as the demonstrator's task.
ToolState follow_reference(const ToolState& measured, const Pose& X_WE_reference, double stiffness, double dt,
                           const ToolState& command) {
  const double damping = 2.0 * std::sqrt(stiffness);
  const Vector3 error = X_WE_reference.p - measured.X_WE.p;
  const Vector3 turn_W = log_rotation(X_WE_reference.R * measured.X_WE.R.transpose());
  const Vector3 linear = stiffness * error - damping * measured.V_WE.linear;
  const Vector3 angular = stiffness * turn_W - damping * measured.V_WE.angular;
  ToolState next;
  next.X_WE.p = command.X_WE.p + dt * (command.V_WE.linear + 0.5 * dt * linear);
  next.X_WE.R = orthonormalized(exp_rotation(dt * (command.V_WE.angular + 0.5 * dt * angular)) * command.X_WE.R);
  next.V_WE = {command.V_WE.linear + dt * linear, command.V_WE.angular + dt * angular};
  return next;
}

}  // namespace

PreparedProgram prepare(Program program, ControllerSettings settings) {
  constexpr const char* kPositive = "a finite number above 0";
  require(is_positive(settings.tick), program, "controller tick", settings.tick, kPositive);
  require(is_positive(settings.task_stiffness), program, "task stiffness", settings.task_stiffness, kPositive);
  require(is_positive(settings.convergence_deg_per_metre), program, "convergence degrees per metre",
          settings.convergence_deg_per_metre, kPositive);
  require(std::isfinite(settings.vacuum_wait) && settings.vacuum_wait >= 0.0, program, "vacuum wait",
          settings.vacuum_wait, "a finite number, 0 or more");
  // The discrete task is stable below sqrt(k) dt = 1; the limit keeps it well damped.
  const double product = std::sqrt(settings.task_stiffness) * settings.tick;
  require(!is_lagged(settings.tracking) || product <= 0.5, program, "task stiffness", settings.task_stiffness,
          "sqrt(stiffness) * tick at most 0.5, else the task oscillates");
  check_limits(settings.limits, program.name);
  if (is_fast(settings.tracking)) {
    const double tempo = tempo_of(settings.tracking);
    require(tempo >= 0.1 && tempo <= 1.0, program, "fast: tempo", tempo, "a number from 0.1 to 1");
    check_fast(settings.fast, program.name);
  }
  if (program.waypoints.empty()) throw InputError(program.name, "", "no rows", "at least one waypoint");

  PreparedProgram plan;
  for (std::size_t row = 0; row < program.waypoints.size(); ++row) {
    const Waypoint& waypoint = program.waypoints[row];
    if (!waypoint.X_WE.p.allFinite() || !waypoint.X_WE.R.allFinite()) {
      throw InputError(place_of(program, row), name_of(waypoint), "a pose that is not finite", "a finite pose");
    }
    plan.row_limits.push_back(find_limits(program, row, settings.limits));
    plan.X_WE.push_back(waypoint.X_WE);
    const std::optional<Swing>& swing = waypoint.swing;
    plan.held_smoothing.push_back(swing ? Smoothing{swing->slow, 0.5 * swing->fast}
                                        : Smoothing{settings.fast.held.window, settings.fast.held.shaper_delay});
  }
  plan.program = std::move(program);
  plan.settings = std::move(settings);
  return plan;
}

ControllerState make_controller_state(const Pose& X_WE_start) noexcept {
  ControllerState state;
  state.X_WE_departure = X_WE_start;
  state.X_WE_reference = X_WE_start;
  state.command.X_WE = X_WE_start;
  return state;
}

ControllerOutput tick(const PreparedProgram& plan, const ToolState& measured, ControllerState& state) noexcept {
  ControllerOutput output;
  const bool goes_fast = is_fast(plan.settings.tracking);
  if (goes_fast) {
    advance_fast(plan, measured, state, output);
  } else {
    advance_program(plan, measured, state, output);
  }
  const double dt = plan.settings.tick;
  if (goes_fast) {
    state.command = sample_fast(plan, state);
    state.X_WE_reference = state.command.X_WE;
  } else if (is_exact(plan.settings.tracking)) {
    if (state.phase == ControllerPhase::Moving) {
      const LspbSegment::Sample at_end = state.segment.sample(static_cast<double>(state.phase_ticks + 1) * dt);
      state.command = {at_end.X_WE, at_end.V_WE};
    }
    state.X_WE_reference = state.command.X_WE;
  } else {
    if (state.phase == ControllerPhase::Moving) {
      state.X_WE_reference = state.segment.sample(static_cast<double>(state.phase_ticks) * dt).X_WE;
    }
    state.command = follow_reference(measured, state.X_WE_reference, plan.settings.task_stiffness, dt, state.command);
  }
  ++state.phase_ticks;
  ++state.tail_ticks;
  ++state.tick_count;
  output.tool = state.command;
  output.X_WE_reference = state.X_WE_reference;
  output.io = state.io;
  output.phase = state.phase;
  output.row = state.row;
  return output;
}

bool will_finish(const PreparedProgram& plan, const ToolState& measured, const ControllerState& state) noexcept {
  return state.phase == ControllerPhase::Moving && state.row + 1 == static_cast<int>(plan.program.waypoints.size()) &&
         has_reached_row(plan, measured, state);
}

bool is_too_early(const PreparedProgram& plan, const ControllerState& state, int row) noexcept {
  const std::optional<double>& not_before = plan.program.waypoints[static_cast<std::size_t>(row)].not_before;
  return not_before && (static_cast<double>(state.tick_count) + 0.5) * plan.settings.tick <= *not_before;
}

double convergence_error(const Pose& X_WE, const Pose& X_WE_target, double convergence_deg_per_metre) noexcept {
  const double angle_deg = angle_between(X_WE.R, X_WE_target.R) * 180.0 / std::numbers::pi;
  return (X_WE_target.p - X_WE.p).norm() + angle_deg / convergence_deg_per_metre;
}

double compute_duration(const PreparedProgram& plan, const Pose& X_WE_start, double longest) {
  ControllerState state = make_controller_state(X_WE_start);
  ToolState measured = state.command;
  const double dt = plan.settings.tick;
  while (static_cast<double>(state.tick_count) * dt < longest) {
    const ControllerOutput output = tick(plan, measured, state);
    if (output.finished_now) return static_cast<double>(state.tick_count - 1) * dt;
    measured = output.tool;
  }
  return longest;
}

}  // namespace snug::motion
