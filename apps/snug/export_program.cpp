// export of programs: for the controllers of real robots.
#include "export_program.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "program_fit.hpp"
#include "robot_warnings.hpp"
#include "snug/cell/corrected.hpp"
#include "snug/cell/held_boxes.hpp"
#include "snug/cell/program_trial.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/control/program_export.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/motion/fitted_limits.hpp"
#include "version.hpp"

namespace snug::app {
namespace {

/// How far a box that is let go may be from where the simulation puts it is not looked at here: that it stays packed
/// is.
constexpr const char* kNotExported =
    "not exported: the robot that follows exactly does not do what was simulated: {} (--unchecked exports it all the "
    "same)";

/// The cup that `simulate` has by default for the program.
cup::CupMode cup_for(const ExportOptions& options) {
  return is_own_program(motion::load_program(options.input)) ? cup::CupMode::Phases : cup::CupMode::Holding;
}

/// A program and the robot that is to do it.
struct LoadedProgram {
  cell::Simulation simulation;
  motion::PreparedProgram plan;  ///< with the tool that lags behind, as it is simulated

  LoadedProgram(const model::Scenario& scenario, const std::string& sequence, const ExportOptions& options)
      : simulation(scenario, sequence, {motion::ControllerKind::Faithful, cup_for(options), scenario.robot->name}),
        plan(simulation.prepare(cell::corrected(scenario, motion::load_program(options.input),
                                                options.corrections == "none" ? "" : options.corrections))) {}

  /// `done`: the motion that is written, as simulated or fitted to that.
  [[nodiscard]] control::RobotProgram for_robot(const motion::PreparedProgram& done,
                                                const ExportOptions& options) const {
    const std::string layer = options.corrections == "none" ? "" : ", corrections " + options.corrections;
    return {done,
            simulation.arm()->model(),
            simulation.arm()->start(),
            find_loads(),
            {fmt::format("snug {}", version_text()),
             fmt::format("program {}, {} rows{}", options.input, plan.program.waypoints.size(), layer),
             fmt::format("scenario {}, sequence {}, robot {}", simulation.scenario().name, simulation.sequence().name,
                         simulation.arm()->model().name)},
            motion::compute_duration(plan, simulation.scenario().controller.X_WE_start)};
  }

  /// The program for a robot that follows exactly: the same rows with speeds and accelerations of the simulated motion.
  [[nodiscard]] motion::PreparedProgram fitted() const {
    motion::PreparedProgram exact = plan;
    exact.settings.kind = motion::ControllerKind::Ideal;
    exact.row_limits = motion::fit_limits(plan, simulation.scenario().controller.X_WE_start);
    return exact;
  }

 private:
  /// What the cup holds on the way to each row, as far as the names of the rows tell; says what they do not tell.
  [[nodiscard]] std::vector<std::optional<control::CarriedLoad>> find_loads() const {
    std::vector<std::optional<control::CarriedLoad>> loads;
    cell::HeldBoxes boxes(simulation.scenario(), simulation.sequence());
    const std::vector<motion::Waypoint>& rows = plan.program.waypoints;
    bool was_unknown = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      boxes.depart(plan.program, static_cast<int>(i),
                   i > 0 ? rows[i - 1].X_WE : simulation.scenario().controller.X_WE_start);
      loads.emplace_back();
      if (const std::optional<cell::HeldBox>& held = boxes.held()) {
        const std::string& id = simulation.sequence().items[static_cast<std::size_t>(held->item)].parcel;
        const SpatialInertia& inertia = model::find_parcel(simulation.scenario(), id)->inertia;
        loads.back() = {inertia.mass, held->X_EP * inertia.com};
      }
      if (boxes.is_unknown() && !was_unknown) {
        std::fprintf(
            stderr,
            "snug: warning: row %zu (%s): no box of sequence %s is known to be held: payload of the gripper alone\n",
            i + 1, rows[i].name.c_str(), simulation.sequence().name.c_str());
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
  return {scenario, sequence, options};
}

/// Whether what is exported may be done: simulates it with contact beside the program as it is simulated otherwise, and
/// says on stderr what is worse. True with --unchecked.
bool is_exportable(const LoadedProgram& program, const motion::PreparedProgram& done, const ExportOptions& options) {
  if (options.is_unchecked) return true;
  const cell::Simulation& lagging = program.simulation;
  const cell::MotionTrial wanted = cell::try_motion(lagging, program.plan);
  cell::MotionTrial trial = wanted;
  if (done.settings.kind == motion::ControllerKind::Ideal) {
    cell::SimulationOptions exact = lagging.options();
    exact.controller = motion::ControllerKind::Ideal;
    trial = cell::try_motion(cell::Simulation(lagging.scenario(), lagging.sequence().name, exact), done);
  }
  const std::string worse = cell::compare_trials(wanted, trial);
  if (worse.empty()) return true;
  std::fprintf(stderr, "snug: %s\n", fmt::format(fmt::runtime(kNotExported), worse).c_str());
  return false;
}

/// Runs the program through the joints and writes what `format` makes of it; nothing when the robot cannot do it.
template <class Format>
int write_run(const ExportOptions& options, OutputFile output, Format format) {
  const LoadedProgram program = load(options);
  const cell::CellArm& arm = *program.simulation.arm();
  const control::JointRun run =
      control::run_joints(program.plan, arm.controller(), control::make_demonstrator_machine(), arm.start());
  if (!run.is_complete) {
    const auto row = static_cast<std::size_t>(std::max(0, run.stuck_row));
    std::fprintf(stderr, "snug: the robot does not reach row %zu (%s): snug check says why\n", row + 1,
                 program.plan.program.waypoints[row].name.c_str());
    return kRunFailed;
  }
  if (!is_exportable(program, program.plan, options)) return kRunFailed;
  write_file(std::move(output), format(run, arm.model(), program));
  std::fprintf(stderr, "%s: %zu rows, %.1f s\n", options.output.c_str(), program.plan.program.waypoints.size(),
               static_cast<double>(run.samples.size()) * program.plan.settings.tick);
  return kSuccess;
}

}  // namespace

int write_urscript(const ExportOptions& options, OutputFile output) {
  if (options.script.vacuum_output == options.script.blow_off_output) {
    throw InputError("command line", "--blow-off-output", std::to_string(options.script.blow_off_output),
                     "another output than --vacuum-output");
  }
  const LoadedProgram program = load(options);
  const motion::PreparedProgram fitted = program.fitted();
  const control::UrScript script = control::format_urscript(program.for_robot(fitted, options), options.script);
  if (!is_exportable(program, fitted, options)) return kRunFailed;
  write_file(std::move(output), script.text);
  std::fprintf(stderr,
               "%s: %d moves, %.1f s nominal from stop to stop; %.1f s simulated, with a controller that lags behind "
               "them\n",
               options.output.c_str(), script.moves, script.nominal_duration, script.simulated_duration);
  return kSuccess;
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
