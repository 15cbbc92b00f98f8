// export of programs: for the controllers of real robots.
#include "apps/snug/export/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "snug/cell/held_boxes.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/control/program_export.hpp"
#include "snug/control/urscript.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/phases.hpp"
#include "snug/model/robot_io.hpp"
#include "snug/motion/fitted_limits.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_fit.hpp"
#include "snug/runs/program_trial.hpp"

namespace snug::app {
namespace {

cell::SimulationOptions simulation_for(const model::Scenario& scenario, const ExportOptions& options) {
  cell::SimulationOptions simulation;
  simulation.cup = runs::cup_for(scenario, layer_of(options.corrections));
  simulation.robot = scenario.robot->name;
  choose_motion(options.motion, read_file(options.input, "a program file (CSV)"), options.input, simulation);
  return simulation;
}

/// A program and the robot that is to do it.
struct LoadedProgram {
  cell::Simulation simulation;
  motion::PreparedProgram plan;  ///< as it is simulated: with the tool that lags behind, or fast
  /// Done in the cell, with contact: of a fast program what is written, since contact ends its waypoints and its waits.
  std::optional<runs::MotionTrial> trial;

  LoadedProgram(const model::Scenario& scenario, const std::string& sequence, const ExportOptions& options)
      : simulation(scenario, sequence, simulation_for(scenario, options)),
        plan(simulation.prepare(
            runs::corrected(scenario, motion::load_program(options.input), layer_of(options.corrections)))) {
    if (!options.is_unchecked) trial = runs::try_motion(simulation, plan);
  }

  [[nodiscard]] bool is_fast() const { return motion::is_fast(plan.settings.tracking); }

  /// `done`: the motion that is written, as simulated or fitted to that.
  [[nodiscard]] control::RobotProgram for_robot(const motion::PreparedProgram& done, const ExportOptions& options,
                                                bool is_ur = false) const {
    const std::string layer = layer_of(options.corrections).empty() ? "" : ", corrections " + options.corrections;
    const std::string tempo = is_fast() ? fmt::format(", tempo {}", motion::tempo_of(plan.settings.tracking)) : "";
    return {.plan = done,
            .arm = simulation.arm()->model(),
            .q_start = simulation.arm()->start(),
            .loads = find_loads(),
            .notes = {fmt::format("snug {}", version_text()),
                      fmt::format("program {}, {} waypoints{}{}", options.input, plan.program.waypoints.size(), layer,
                                  tempo),
                      fmt::format("scenario {}, sequence {}, robot {}", simulation.scenario().name,
                                  simulation.sequence().name, simulation.arm()->model().name)},
            .flange = is_ur || has_tool0() ? "tool0" : simulation.scenario().robot->flange_frame};
  }

  /// The program for a robot that follows exactly: the same waypoints with speeds and accelerations of the simulated
  /// motion.
  [[nodiscard]] motion::PreparedProgram fitted() const {
    motion::PreparedProgram exact = plan;
    exact.row_limits = motion::fit_limits(exact, X_WE_start());
    exact.settings.tracking = motion::ExactTracking{};
    return exact;
  }

  /// The flange's frame as UR, ROS-Industrial and others name it.
  [[nodiscard]] bool has_tool0() const { return robot::find_link(simulation.arm()->model(), "tool0") >= 0; }

  [[nodiscard]] const Pose& X_WE_start() const { return simulation.scenario().controller.X_WE_start; }

 private:
  /// What the cup holds on the path to each waypoint, as far as they tell; says what they do not tell.
  [[nodiscard]] std::vector<std::optional<control::CarriedLoad>> find_loads() const {
    std::vector<std::optional<control::CarriedLoad>> loads;
    cell::HeldBoxes boxes(simulation.scenario(), simulation.sequence());
    const std::vector<motion::Waypoint>& waypoints = plan.program.waypoints;
    bool was_unknown = false;
    for (std::size_t i = 0; i < waypoints.size(); ++i) {
      boxes.depart(plan.program, static_cast<int>(i), i > 0 ? plan.X_WE[i - 1] : X_WE_start());
      loads.emplace_back();
      if (const std::optional<cell::HeldBox>& held = boxes.held()) {
        const std::string& id = simulation.sequence().items[static_cast<std::size_t>(held->item)].parcel;
        const SpatialInertia& inertia = model::find_parcel(simulation.scenario(), id)->inertia;
        const Matrix3& R_EP = held->X_EP.R;
        loads.back() = {inertia.mass, held->X_EP * inertia.com, R_EP * inertia.inertia * R_EP.transpose()};
      }
      if (boxes.is_unknown() && !was_unknown) {
        std::fprintf(stderr,
                     "snug: warning: waypoint %zu (%s): no box of sequence %s is known to be held: payload of the "
                     "gripper alone\n",
                     i + 1, motion::name_of(waypoints[i]).c_str(), simulation.sequence().name.c_str());
      }
      was_unknown = boxes.is_unknown();
    }
    return loads;
  }
};

LoadedProgram load(const ExportOptions& options) {
  if (options.scenario.empty()) {
    throw InputError("command line", "--scenario", "nothing", "the scenario file with the robot that does the program");
  }
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (!scenario.robot) throw InputError(options.scenario, "robot", "", "a scenario with a robot");
  expect_distinct(files_of(options.scenario, options.changes, scenario), {{"-o", options.output}});
  print_robot_warnings(scenario);
  std::string sequence = options.sequence;
  if (sequence.empty() && !scenario.sequences.empty()) sequence = scenario.sequences.front().name;
  runs::require_fit(scenario, sequence, motion::load_program(options.input));
  return {scenario, sequence, options};
}

/// Says why nothing is exported, unless nothing is wrong.
bool accept(const char* what, const std::string& wrong) {
  if (!wrong.empty()) {
    std::fprintf(stderr, "snug: not exported: %s: %s (--unchecked exports it all the same)\n", what, wrong.c_str());
  }
  return wrong.empty();
}

/// Whether the program, tried in the scenario's cell, does not stop there, and packs every box that it picks. True with
/// --unchecked.
bool has_succeeded(const LoadedProgram& program) {
  if (!program.trial) return true;
  return accept("it does not succeed in the simulated cell", runs::find_loss(*program.trial));
}

/// Whether a robot that follows the waypoints of `fitted` exactly does not do worse in the cell than was simulated. How
/// far a box that is let go may be from where the simulation puts it is not checked: that it stays packed is.
bool is_as_good(const motion::PreparedProgram& fitted, const LoadedProgram& program) {
  if (!program.trial) return true;
  const cell::Simulation& own = program.simulation;
  cell::SimulationOptions exact = own.options();
  exact.tracking = motion::ExactTracking{};
  const cell::Simulation follower(own.scenario(), own.sequence().name, exact);
  return accept("the robot that follows exactly does not do what was simulated",
                runs::compare_trials(*program.trial, runs::try_motion(follower, fitted)));
}

/// The program through the joints. None, which is said on stderr, when the robot cannot do it.
std::optional<control::JointRun> find_run(const LoadedProgram& program) {
  const cell::CellArm& arm = *program.simulation.arm();
  if (program.is_fast() && !has_succeeded(program)) return std::nullopt;
  control::JointRun run =
      program.is_fast() && program.trial
          ? program.trial->joints
          : control::run_joints(program.plan, arm.controller(), control::make_demonstrator_machine(), arm.start());
  if (!run.is_complete) {
    const auto stuck = static_cast<std::size_t>(std::max(0, run.stuck_row));
    std::fprintf(stderr, "snug: the robot does not reach waypoint %zu (%s): snug check says why\n", stuck + 1,
                 motion::name_of(program.plan.program.waypoints[stuck]).c_str());
    return std::nullopt;
  }
  if (!program.is_fast() && !has_succeeded(program)) return std::nullopt;
  return run;
}

/// Writes what `format` makes of the program through the joints; nothing when the robot cannot do it.
template <class Format>
int write_run(const ExportOptions& options, OutputFile output, Format format) {
  const LoadedProgram program = load(options);
  const std::optional<control::JointRun> run = find_run(program);
  if (!run) return kRunFailed;
  write_file(std::move(output), format(*run, program.simulation.arm()->model(), program));
  std::fprintf(stderr, "%s: %zu waypoints, %.1f s\n", options.output.c_str(), program.plan.program.waypoints.size(),
               static_cast<double>(run->samples.size()) * program.plan.settings.tick);
  return kSuccess;
}

/// Waypoints as straight moves.
int write_moves(const ExportOptions& options, const control::UrScriptOptions& script_options,
                const LoadedProgram& program, OutputFile output) {
  const motion::PreparedProgram moves = program.is_fast() ? program.plan : program.fitted();
  control::RobotProgram robot_program = program.for_robot(moves, options, true);
  robot_program.simulated_duration = motion::compute_duration(program.plan, program.X_WE_start());
  const control::UrScript script = control::format_urscript(robot_program, script_options);
  if (!has_succeeded(program)) return kRunFailed;
  if (!program.is_fast() && !is_as_good(moves, program)) return kRunFailed;
  write_file(std::move(output), script.text);
  std::fprintf(stderr,
               "%s: %d moves, %.1f s nominal from stop to stop; %.1f s simulated, with a controller that lags behind\n",
               options.output.c_str(), script.moves, script.nominal_duration, script.simulated_duration);
  return kSuccess;
}

/// The part of a run from a waypoint on, which is gone to at rest: where the tool is highest on the path there from
/// what was let go before.
control::JointRun cut_run(const control::JointRun& run, std::size_t first_row, double tick) {
  if (first_row == 0) return run;
  const auto& samples = run.samples;
  std::size_t end = 0;
  while (end < samples.size() && samples[end].row < static_cast<int>(first_row)) ++end;
  while (end + 1 < samples.size() && !samples[end + 1].io.vacuum) ++end;
  std::size_t begin = end;
  while (begin > 0 && !samples[begin - 1].io.vacuum) --begin;
  std::size_t highest = begin;
  for (std::size_t i = begin; i <= end; ++i) {
    if (samples[i].tool.X_WE.p.z() > samples[highest].tool.X_WE.p.z()) highest = i;
  }
  std::size_t stop = highest + 1;  // the joints rest there: up to it the ramp may go
  while (stop < end && samples[stop].before.qd.norm() > control::kAlmostAtRest) ++stop;
  constexpr std::size_t kMostRamp = 60;
  const std::size_t ramp = std::min(kMostRamp, stop - highest);
  return ramp == 0 || highest + ramp >= samples.size() ? run : control::begin_at(run, highest, ramp, tick);
}

/// Joints in time.
int write_targets(const ExportOptions& options, const control::UrScriptOptions& script_options,
                  const LoadedProgram& program, OutputFile output) {
  const std::optional<control::JointRun> run = find_run(program);
  if (!run) return kRunFailed;
  const control::JointRun part = cut_run(*run, script_options.first_row, program.plan.settings.tick);
  const control::UrServoScript script =
      control::format_servo_urscript(part, program.for_robot(program.plan, options, true), script_options);
  write_file(std::move(output), script.text);
  std::fprintf(stderr, "%s: %zu knots, %.0f kB; %.1f s and waits for the vacuum; %.1f s simulated\n",
               options.output.c_str(), script.knots, static_cast<double>(script.text.size()) / 1e3,
               script.followed_duration, script.simulated_duration);
  return kSuccess;
}

/// The first waypoint of the box with which the program is to begin.
std::size_t find_first_row(const ExportOptions& options, const LoadedProgram& program) {
  if (options.from_box.empty()) return 0;
  const std::vector<motion::Waypoint>& waypoints = program.plan.program.waypoints;
  std::vector<std::string> picked;
  for (const model::Item& item : program.simulation.sequence().items) {
    const auto is_its = [&](const motion::Waypoint& waypoint) {
      const bool is_before =
          waypoint.motion_class == motion::MotionClass::PrePick || waypoint.motion_class == motion::MotionClass::Pick;
      return is_before && motion::fit_of(waypoint, item.parcel) > 0;
    };
    const auto first = std::ranges::find_if(waypoints, is_its);
    if (first == waypoints.end()) continue;
    if (item.parcel == options.from_box) return static_cast<std::size_t>(first - waypoints.begin());
    picked.push_back(item.parcel);
  }
  const std::string_view nearest = find_nearest(options.from_box, picked);
  throw InputError("command line", "--from-box", "'" + options.from_box + "'",
                   fmt::format("a box that the program picks: {}{}", fmt::join(picked, ", "),
                               nearest.empty() ? "" : fmt::format("; nearest is '{}'", nearest)));
}

/// How the cell is wired, with what the command line says otherwise.
control::UrScriptOptions script_options(const ExportOptions& options, const LoadedProgram& program) {
  control::UrScriptOptions script = options.script;
  const model::Scenario& scenario = program.simulation.scenario();
  script.io = model::robot_io(scenario);
  const auto standard = [](int number) { return model::DigitalIo{model::DigitalKind::Standard, number, false}; };
  if (options.vacuum_output) script.io.vacuum = standard(*options.vacuum_output);
  if (options.blow_off_output) script.io.blow_off = standard(*options.blow_off_output);
  if (options.vacuum_input) script.io.vacuum_reached = standard(*options.vacuum_input);
  if (options.part_input) script.io.part_present = standard(*options.part_input);
  if (script.io.blow_off && script.io.vacuum.bit() == script.io.blow_off->bit()) {
    throw InputError("command line", "--blow-off-output", fmt::format("output {}", script.io.vacuum.number),
                     "another output than --vacuum-output");
  }
  if (script.io.vacuum_reached && script.io.part_present &&
      script.io.vacuum_reached->bit() == script.io.part_present->bit()) {
    throw InputError("command line", "--part-input", fmt::format("input {}", script.io.part_present->number),
                     "another input than --vacuum-input");
  }
  script.pressure_reached = cup::kEstablishedVacuum * scenario.cup.vacuum.pressure_gauge_hold;
  script.first_row = find_first_row(options, program);
  return script;
}

}  // namespace

int write_urscript(const ExportOptions& options, OutputFile output) {
  const LoadedProgram program = load(options);
  const control::UrScriptOptions script = script_options(options, program);
  return program.is_fast() && !script.is_dry ? write_targets(options, script, program, std::move(output))
                                             : write_moves(options, script, program, std::move(output));
}

int write_ros_trajectory(const ExportOptions& options, OutputFile output) {
  return write_run(options, std::move(output),
                   [&](const control::JointRun& run, const robot::ArmModel&, const LoadedProgram& program) {
                     return control::format_ros_trajectory(run, program.for_robot(program.plan, options),
                                                           options.period);
                   });
}

int write_mc_rtc_csv(const ExportOptions& options, OutputFile output) {
  return write_run(options, std::move(output),
                   [](const control::JointRun& run, const robot::ArmModel& arm, const LoadedProgram& program) {
                     return control::format_log_csv(control::make_log(run, arm, program.simulation.scenario().gravity));
                   });
}

int write_mc_rtc_flat(const ExportOptions& options, OutputFile output) {
  return write_run(
      options, std::move(output),
      [](const control::JointRun& run, const robot::ArmModel& arm, const LoadedProgram& program) {
        return control::format_log_flat(control::make_log(run, arm, program.simulation.scenario().gravity));
      });
}

}  // namespace snug::app
