// URScript: rows as straight moves (movel).
#include "snug/control/urscript.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "snug/control/internal/program_text.hpp"
#include "snug/control/internal/urscript_parts.hpp"
#include "snug/core/check.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::control {
namespace {

using internal::check_is_ur, internal::format_header, internal::format_outputs, internal::format_part_wait,
    internal::format_pose, internal::format_script_payload, internal::format_start, internal::format_wait,
    internal::pose_at_zero, internal::wait_function;

constexpr double kFlyBy = 0.05;  ///< m, precision from which a row is passed without a stop
// Of the shorter of the moves on either side: two blends on one move then leave a tenth of it between them. (A
// controller skips a waypoint whose blend overlaps another.)
constexpr double kBlendShare = 0.45;
constexpr double kLeastBlend = 1e-3;  ///< m, below it a blend is a stop
// A row nearer than both to the one before needs no move; a UR10 repeats poses to 0.1 mm.
constexpr double kNoWay = 5e-5;   ///< m
constexpr double kNoTurn = 1e-4;  ///< rad

/// Whether the tool holds its pose until the vacuum has changed.
bool waits(const motion::IO& before, const motion::IO& io) {
  return io.vacuum != before.vacuum || (io.blow_off && !before.blow_off);
}

/// A row as the robot's controller gets it.
struct ScriptRow {
  std::size_t row = 0;
  motion::IO before;  ///< switches until then
  bool moves = false;
  double length = 0.0;    ///< m
  double duration = 0.0;  ///< s, from stop to stop
  bool turn_decides = false;
  double blend = 0.0;  ///< m
};

// Of a dry run.
constexpr double kDryHeight = 0.020;  ///< m, above each row
constexpr double kDrySpeed = 0.25;    ///< of each row's

bool is_pick(const motion::Waypoint& waypoint) { return waypoint.motion_class == motion::MotionClass::Pick; }

std::vector<ScriptRow> plan_rows(const motion::PreparedProgram& plan, const Pose& X_WE_start,
                                 const UrScriptOptions& options) {
  std::vector<ScriptRow> rows;
  Pose X_WE = X_WE_start;
  motion::IO io;
  for (std::size_t i = options.first_row; i < plan.program.waypoints.size(); ++i) {
    const motion::Waypoint& waypoint = plan.program.waypoints[i];
    const motion::MotionLimits& limits = plan.row_limits[i];
    const motion::LspbSegment segment(X_WE, plan.X_WE[i], limits);
    ScriptRow row;
    row.row = i;
    row.before = io;
    row.length = segment.translation().length;
    row.moves = row.length >= kNoWay || segment.rotation().length >= kNoTurn;
    if (row.moves) {
      row.duration = segment.duration();
      const motion::LspbProfile fastest =
          motion::plan_fastest_profile(row.length, limits.max_speed, limits.max_acceleration);
      row.turn_decides = segment.duration() > fastest.duration * (1.0 + 1e-9);
      X_WE = plan.X_WE[i];
    }
    if (row.moves || i == options.first_row || waypoint.io != io) rows.push_back(row);
    io = waypoint.io;
  }
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    const ScriptRow& next = rows[k + 1];
    const motion::IO& after = plan.program.waypoints[next.row].io;
    const bool waits_for_part = options.io.part_present && is_pick(plan.program.waypoints[next.row]);
    if (waits_for_part || !rows[k].moves || !next.moves || next.before.vacuum != after.vacuum ||
        next.before.blow_off != after.blow_off)
      continue;
    const double precision = plan.row_limits[rows[k].row].precision;
    const double blend = std::min(precision, kBlendShare * std::min(rows[k].length, next.length));
    if (precision >= kFlyBy && blend >= kLeastBlend) rows[k].blend = blend;
  }
  return rows;
}

/// Outputs of a row, what is waited for then, and the payload; adds to `duration` [s] what that takes.
std::string format_changes(const RobotProgram& program, const ScriptRow& row, const UrScriptOptions& options,
                           double& duration) {
  const motion::Waypoint& waypoint = program.plan.program.waypoints[row.row];
  const double vacuum_wait = program.plan.settings.vacuum_wait;
  std::string text = format_outputs(row.before, waypoint.io, options);
  if (waypoint.io.vacuum != row.before.vacuum) {
    text += format_wait(waypoint) + format_script_payload(program, program.loads[row.row], options);
    duration += vacuum_wait + (waypoint.io.vacuum ? 0.0 : options.vent_time);
  } else if (waits(row.before, waypoint.io) && vacuum_wait > 0.0) {  // a puff: nothing to sense
    text += fmt::format("  sleep({:.3f})\n", vacuum_wait);
    duration += vacuum_wait;
  }
  return text;
}

}  // namespace

UrScript format_urscript(const RobotProgram& program, const UrScriptOptions& options) {
  check_is_ur(program.arm);
  const motion::PreparedProgram& plan = program.plan;
  const std::vector<motion::Waypoint>& waypoints = plan.program.waypoints;
  SNUG_CHECK(program.loads.size() == waypoints.size(), "one load for each row");
  const Pose X_BaseW = pose_at_zero(program.arm, "base").inverse();
  const Pose X_WE_start = robot::forward_tool(program.arm, program.q_start);
  const std::vector<ScriptRow> rows = plan_rows(plan, X_WE_start, options);
  const double slowness = options.is_dry ? 1.0 / kDrySpeed : 1.0;
  const Vector3 p_up(0.0, 0.0, options.is_dry ? kDryHeight : 0.0);

  UrScript script;
  std::string body;
  for (const ScriptRow& row : rows) {
    const motion::Waypoint& waypoint = waypoints[row.row];
    const motion::MotionLimits& limits = plan.row_limits[row.row];
    body += fmt::format("  # {} {}\n", row.row + 1, motion::name_of(waypoint));
    if (!options.is_dry) body += format_changes(program, row, options, script.nominal_duration);
    if (!row.moves) continue;
    if (is_pick(waypoint)) body += format_part_wait(waypoint, options);
    const Pose X_WE{plan.X_WE[row.row].R, plan.X_WE[row.row].p + p_up};
    body += fmt::format("  movel({}, a={:.5f}, v={:.5f}{}{})\n", format_pose(X_BaseW * X_WE),
                        limits.max_acceleration / (slowness * slowness), limits.max_speed / slowness,
                        row.turn_decides ? fmt::format(", t={:.3f}", slowness * row.duration) : "",
                        row.blend > 0.0 ? fmt::format(", r={:.4f}", row.blend) : "");
    script.nominal_duration += slowness * row.duration;
    ++script.moves;
  }
  script.simulated_duration = program.simulated_duration > 0.0
                                  ? program.simulated_duration
                                  : motion::compute_duration(plan, X_WE_start, motion::kLongestProgram);

  std::string& text = script.text;
  text = format_header(program, "m, m/s, m/s^2, rad, s; payloads in kg and m; poses in the controller's base frame");
  if (options.is_dry) {
    text += fmt::format("# A dry run: {} mm above every row, at {} of its speed, nothing is switched.\n",
                        1e3 * kDryHeight, kDrySpeed);
  }
  text += "def snug_program():\n";
  text +=
      fmt::format("  # {:.1f} s nominal from the start pose: {} moves from stop to stop (blends make them shorter),\n",
                  script.nominal_duration, script.moves);
  text += fmt::format(
      "  # {} s at each change of vacuum, {} s more until it is gone. Simulated: {:.1f} s, with a controller that lags "
      "behind.\n",
      plan.settings.vacuum_wait, options.vent_time, script.simulated_duration);
  text += wait_function(options) + format_start(program, program.q_start, options);
  text += body + "end\n";
  return script;
}

}  // namespace snug::control
