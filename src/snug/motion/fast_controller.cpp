// Fast controller: one tick of our own programs: exact tracking, blends, rows and waits that end by what is felt.
#include "snug/motion/fast_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::motion {
namespace {

// m and, by the convergence angle, rad: joints that are behind by more have not arrived. Below every precision of the
// scenarios.
constexpr double kArrived = 0.002;
/// The same, of a tool that is too late to be blended into the next way: it would cut the corner.
constexpr double kLate = 0.02;
/// Of the shorter of two motions: over at most so much of it they are blended.
constexpr double kLargestBlend = 0.4;
/// m: what goes straight up has cleared its neighbours so far before its end, and may begin to go away. Of that way
/// the largest fraction, as nothing is blended at its beginning.
constexpr double kRiseBlend = 0.08, kLargestRiseBlend = 0.65;
/// A way that rises or falls by less than this, and this share of its level length, is level.
constexpr double kLevel = 0.01;  ///< m
constexpr double kGentleSlope = 0.2;
constexpr double kPlumb = 1e-4;     ///< m and rad
constexpr double kUpright = 0.966;  ///< cosine of 15 degrees

const Waypoint& row_of(const PreparedProgram& plan, int row) {
  return plan.program.waypoints[static_cast<std::size_t>(row)];
}

const Pose& pose_of(const PreparedProgram& plan, int row) { return plan.X_WE[static_cast<std::size_t>(row)]; }

bool is_contact_row(const PreparedProgram& plan, int row) { return is_contact(row_of(plan, row).motion_class); }

/// This row asks for no motion from the one before: it only switches.
bool only_switches(const PreparedProgram& plan, int row) {
  return row > 0 && pose_of(plan, row) == pose_of(plan, row - 1);
}

bool has_next(const PreparedProgram& plan, int row) {
  return row + 1 < static_cast<int>(plan.program.waypoints.size());
}

bool is_insertion(const Waypoint& waypoint) {
  return waypoint.io.vacuum && waypoint.motion_class == MotionClass::Place;
}

bool is_detaching(const Waypoint& waypoint) {
  return waypoint.io.blow_off && !waypoint.io.vacuum && !is_contact(waypoint.motion_class);
}

/// Switching so, the tool stands still until the cup has followed.
bool has_to_wait(const IO& before, const IO& after) {
  return after.vacuum != before.vacuum || (after.blow_off && !before.blow_off);
}

bool is_plumb(const Pose& X_WA, const Pose& X_WB) {
  return (X_WB.p - X_WA.p).head<2>().norm() < kPlumb && angle_between(X_WA.R, X_WB.R) < kPlumb;
}

double seconds_in_phase(const PreparedProgram& plan, const ControllerState& state) {
  return static_cast<double>(state.phase_ticks) * plan.settings.tick;
}

double seconds_of_tail(const PreparedProgram& plan, const ControllerState& state) {
  return static_cast<double>(state.tail_ticks) * plan.settings.tick;
}

bool has_tail(const PreparedProgram& plan, const ControllerState& state) {
  return seconds_of_tail(plan, state) < state.tail.duration();
}

/// Where the tool is told to be `ahead` seconds after the start of this tick.
ToolState reference_at(const PreparedProgram& plan, const ControllerState& state, double ahead) {
  const double t = seconds_in_phase(plan, state) + ahead;
  if (!has_tail(plan, state)) return state.paced.sample(t);
  const ToolState tail = state.tail.sample(seconds_of_tail(plan, state) + ahead);
  const PacedSegment::Increment on_top = state.paced.increment(t);
  return {{on_top.R_W * tail.X_WE.R, tail.X_WE.p + on_top.shift_W},
          {tail.V_WE.linear + on_top.V_W.linear, on_top.V_W.angular + on_top.R_W * tail.V_WE.angular}};
}

double error_to(const PreparedProgram& plan, const Pose& X_WE, int row) {
  return convergence_error(X_WE, pose_of(plan, row), plan.settings.convergence_deg_per_metre);
}

/// N, that a held box, or the cup, may feel against the motion to this row; infinite where nothing is meant to be felt.
double force_limit(const PreparedProgram& plan, int row) {
  const FastSettings& fast = plan.settings.fast;
  const Waypoint& waypoint = row_of(plan, row);
  const MotionClass motion_class = waypoint.motion_class;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!waypoint.io.vacuum) {
    return motion_class == MotionClass::Pick || motion_class == MotionClass::RePick ? fast.pick_force : kNone;
  }
  if (motion_class == MotionClass::PlaceSlow) return fast.push_force;
  return is_contact(motion_class) ? fast.press_force : kNone;
}

bool feels_contact(const PreparedProgram& plan, const ControllerState& state) {
  const double limit = force_limit(plan, state.row);
  if (!std::isfinite(limit)) return false;
  const double left = (state.paced.end().p - state.command.X_WE.p).norm();
  if (left > plan.settings.fast.feel_within) return false;
  const FastSettings& fast = plan.settings.fast;
  const double felt_hold = std::min(fast.felt_hold, fast.felt_hold_share * state.hold_factor_before);
  if (row_of(plan, state.row).io.vacuum && state.sensed.hold_factor < felt_hold) return true;
  return -(state.sensed.force_W - state.force_before_W).dot(state.paced.direction_W()) > limit;
}

bool goes_level(const Vector3& from, const Vector3& to) {
  const Vector3 way = to - from;
  return std::abs(way.z()) < kLevel + kGentleSlope * way.head<2>().norm();
}

/// m, from a row where the next one may begin; 0: the tool stops there.
double blend_at(const PreparedProgram& plan, const ControllerState& state) {
  if (!has_next(plan, state.row)) return 0.0;
  if (is_contact_row(plan, state.row)) return 0.0;
  const Waypoint &waypoint = row_of(plan, state.row), &after = row_of(plan, state.row + 1);
  if (after.not_before) return 0.0;
  if (waypoint.io != after.io && (!is_detaching(waypoint) || has_to_wait(waypoint.io, after.io))) return 0.0;
  const Pose &row = pose_of(plan, state.row), &next = pose_of(plan, state.row + 1);
  const double degrees = plan.settings.convergence_deg_per_metre;
  const double to = convergence_error(state.paced.start(), row, degrees);
  const double from = convergence_error(row, next, degrees);
  if (to < kArrived) return kArrived;  // the tool is there already: it does not stop for the rest
  const Vector3 rise = row.p - state.paced.start().p;
  const bool touches_next = is_contact_row(plan, state.row + 1);
  if (!touches_next && rise.z() > 0.0 && is_plumb(state.paced.start(), row)) {
    return std::min(kRiseBlend, kLargestRiseBlend * std::min(to, from));
  }
  const bool is_level = goes_level(state.paced.start().p, row.p) && goes_level(row.p, next.p) && !touches_next;
  const double largest = is_level ? plan.settings.fast.level_blend : plan.settings.fast.blend;
  return std::min(largest, kLargestBlend * std::min(to, from));
}

Way way_to(const PreparedProgram& plan, const Pose& X_WE, int row) {
  const Pose& goal = pose_of(plan, row);
  return is_contact_row(plan, row) ? Way(X_WE, goal) : Way(X_WE, goal, plan.settings.fast.pan_axis);
}

/// What bounds the motion from X_WE to the row; the joints may bound it more.
Pace pace_of(const PreparedProgram& plan, const Pose& X_WE, int row) noexcept {
  const FastSettings& fast = plan.settings.fast;
  const Waypoint& waypoint = row_of(plan, row);
  Pace pace = waypoint.io.vacuum ? fast.held : fast.empty;
  if (waypoint.io.vacuum) {
    const Smoothing& smoothing = plan.held_smoothing[static_cast<std::size_t>(row)];
    pace.window = smoothing.window;
    pace.shaper_delay = smoothing.shaper_delay;
  }
  if (is_contact(waypoint.motion_class)) {
    const MotionLimits& limits = plan.row_limits[static_cast<std::size_t>(row)];
    pace = {limits.max_speed, limits.max_acceleration, limits.max_turn_speed, limits.max_turn_acceleration,
            fast.contact_window};
  }
  if (is_insertion(waypoint)) {
    pace = fast.insert;
    if (row > 0 && is_contact_row(plan, row - 1)) pace.window = fast.contact_window;  // pressed where it stands
  }
  if (is_detaching(waypoint)) pace = fast.detach;
  if (waypoint.io.vacuum && is_plumb(X_WE, pose_of(plan, row))) {
    const bool is_upright = std::abs(X_WE.R(2, 2)) > kUpright;
    const bool is_lift = pose_of(plan, row).p.z() > X_WE.p.z();
    pace.before_average = 1.0;  // the window is no longer than a heavy box bounces
    if (is_upright || is_lift) pace.window = std::min(pace.window, fast.insert.window);
    pace.shaper_delay = is_insertion(waypoint) && waypoint.swing ? 0.5 * waypoint.swing->slow : 0.0;
    if (is_lift && !is_upright && waypoint.swing) {
      pace.max_speed = std::min(pace.max_speed, 2.0 * std::numbers::pi / waypoint.swing->slow * fast.lift_swing);
    }
  }
  const double tempo =
      tempo_of(plan.settings.tracking) * (waypoint.io.vacuum && waypoint.swing ? waypoint.swing->pace : 1.0);
  pace.max_speed *= tempo;
  pace.max_turn_speed *= tempo;
  pace.max_acceleration *= tempo * tempo;
  pace.max_turn_acceleration *= tempo * tempo;
  return pace;
}

void begin_motion(const PreparedProgram& plan, const Pose& X_WE, ControllerState& state) {
  state.phase = ControllerPhase::Moving;
  state.phase_ticks = 0;
  state.force_before_W = state.sensed.force_W;
  state.hold_factor_before = state.sensed.hold_factor;
  state.paced = PacedSegment(way_to(plan, X_WE, state.row), pace_of(plan, X_WE, state.row), plan.path_limits);
}

void depart(const PreparedProgram& plan, int row, ControllerState& state) {
  const IO& io = row_of(plan, row).io;
  const bool waits = has_to_wait(state.io, io);
  const bool is_moving = state.phase == ControllerPhase::Moving && row > 0 && !state.was_felt &&
                         seconds_in_phase(plan, state) < state.paced.duration();
  state.row = row;
  state.io = io;
  if (is_moving && only_switches(plan, row)) return;  // on the fly: the motion goes on
  if (is_moving) {                                    // a blend: the rest of the motion is put under the next one
    state.tail = state.paced;
    state.tail_ticks = state.phase_ticks;
    state.X_WE_departure = state.paced.end();
    begin_motion(plan, state.X_WE_departure, state);
    return;
  }
  state.was_felt = false;
  state.tail = PacedSegment();
  state.command.V_WE = {};
  state.X_WE_departure = state.command.X_WE;
  state.phase_ticks = 0;
  if (waits && plan.settings.vacuum_wait > 0.0) {
    state.phase = ControllerPhase::Waiting;
  } else {
    begin_motion(plan, state.X_WE_departure, state);
  }
}

bool has_waited(const PreparedProgram& plan, const ControllerState& state) {
  const FastSettings& fast = plan.settings.fast;
  if (seconds_in_phase(plan, state) >= plan.settings.vacuum_wait - 1e-9) return true;
  if (!state.io.vacuum) return state.sensed.pressure_gauge >= fast.released_pressure;
  const std::optional<Swing>& swing = row_of(plan, state.row).swing;
  const bool is_heavy = swing && swing->pace < 1.0;
  return state.sensed.pressure_gauge <= (is_heavy ? fast.fully_sealed_pressure : fast.sealed_pressure);
}

}  // namespace

bool has_reached_fast(const PreparedProgram& plan, const ToolState& measured, const ControllerState& state) noexcept {
  const double t = seconds_in_phase(plan, state);
  if (t >= state.paced.duration() && !has_tail(plan, state)) {
    return convergence_error(measured.X_WE, state.command.X_WE, plan.settings.convergence_deg_per_metre) <= kArrived;
  }
  if (has_tail(plan, state)) return false;
  // Left on the way, the cup letting go as it moves (docs/packing-execution.md, pivot).
  const bool is_left_moving = row_of(plan, state.row).motion_class == MotionClass::TwistDrag &&
                              has_next(plan, state.row) && only_switches(plan, state.row + 1);
  if (is_left_moving) {
    const double precision = plan.row_limits[static_cast<std::size_t>(state.row)].precision;
    return error_to(plan, state.command.X_WE, state.row) <= precision;
  }
  const double blend = blend_at(plan, state);
  const bool is_late =
      convergence_error(measured.X_WE, state.command.X_WE, plan.settings.convergence_deg_per_metre) > kLate;
  if (blend > 0.0 && !is_late && error_to(plan, state.command.X_WE, state.row) <= blend) return true;
  return feels_contact(plan, state);
}

void advance_fast(const PreparedProgram& plan, const ToolState& measured, ControllerState& state,
                  ControllerOutput& output) noexcept {
  if (state.phase == ControllerPhase::Ready) {
    state.command.X_WE = measured.X_WE;
    depart(plan, 0, state);
    output.departed = 0;
  } else if (state.phase == ControllerPhase::Waiting) {
    if (has_waited(plan, state)) begin_motion(plan, state.X_WE_departure, state);
  } else if (state.phase == ControllerPhase::Moving && has_reached_fast(plan, measured, state)) {
    output.reached = state.row;
    state.was_felt = feels_contact(plan, state);
    const bool is_last = !has_next(plan, state.row);
    if (is_last || is_too_early(plan, state, state.row + 1)) {
      state.phase = is_last ? ControllerPhase::Finished : ControllerPhase::Standing;
      state.phase_ticks = 0;
      state.command.V_WE = {};
      output.finished_now = is_last;
    } else {
      depart(plan, state.row + 1, state);
      output.departed = state.row;
    }
  } else if (state.phase == ControllerPhase::Standing && !is_too_early(plan, state, state.row + 1)) {
    state.command.X_WE = measured.X_WE;  // as a motion that is sent by itself
    depart(plan, state.row + 1, state);
    output.departed = state.row;
  }
}

ToolState sample_fast(const PreparedProgram& plan, const ControllerState& state) noexcept {
  if (state.phase != ControllerPhase::Moving) return {state.command.X_WE, {}};
  return reference_at(plan, state, plan.settings.tick);
}

void check_fast(const FastSettings& settings, const std::string& where) {
  const auto require = [&](const char* key, double value, bool ok, const char* expected) {
    if (!ok) throw InputError(where, fmt::format("fast: {}", key), fmt::format("{}", value), expected);
  };
  for (const Pace& pace : {settings.empty, settings.held, settings.held_gently, settings.insert, settings.detach}) {
    for (const double value :
         {pace.max_speed, pace.max_acceleration, pace.max_turn_speed, pace.max_turn_acceleration, pace.window}) {
      require("pace", value, is_positive(value), "a finite number above 0");
    }
  }
  for (const double value :
       {settings.lift_swing, settings.contact_window, settings.blend, settings.level_blend, settings.feel_within,
        settings.pick_force, settings.press_force, settings.push_force, settings.felt_hold, settings.felt_hold_share}) {
    require("limits", value, is_positive(value), "a finite number above 0");
  }
}

}  // namespace snug::motion
