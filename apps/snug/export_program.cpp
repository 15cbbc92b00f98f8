// export of programs: for the controllers of real robots.
#include "export_program.hpp"

#include <cstdio>

#include "snug/cell/corrected.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/control/program_export.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

/// A program and the robot that is to do it.
struct RobotProgram {
  cell::Simulation simulation;
  motion::PreparedProgram plan;

  RobotProgram(const model::Scenario& scenario, const std::string& sequence, const ExportOptions& options)
      : simulation(scenario, sequence, {motion::ControllerKind::Faithful, cup::CupMode::Holding, scenario.robot->name}),
        plan(simulation.prepare(cell::corrected(scenario, motion::load_program(options.input),
                                                options.corrections == "none" ? "" : options.corrections))) {}
};

RobotProgram load(const ExportOptions& options) {
  if (options.scenario.empty()) {
    throw InputError("command line", "--scenario", "nothing", "the scenario file with the robot that does the program");
  }
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (!scenario.robot) throw InputError(options.scenario, "robot", "", "a scenario with a robot");
  expect_distinct(files_of(options.scenario, options.changes, scenario), {{"-o", options.output}});
  std::string sequence = options.sequence;
  if (sequence.empty() && !scenario.sequences.empty()) sequence = scenario.sequences.front().name;
  return {scenario, sequence, options};
}

/// Runs the program through the joints and writes what `format` makes of it; nothing when the robot cannot do it.
template <class Format>
int write_run(const ExportOptions& options, OutputFile output, Format format) {
  const RobotProgram program = load(options);
  const cell::CellArm& arm = *program.simulation.arm();
  const control::JointRun run =
      control::run_joints(program.plan, arm.controller(), control::make_demonstrator_machine(), arm.start());
  if (!run.is_complete) {
    const auto row = static_cast<std::size_t>(std::max(0, run.stuck_row));
    std::fprintf(stderr, "snug: the robot does not reach row %zu (%s): snug check says why\n", row + 1,
                 program.plan.program.waypoints[row].name.c_str());
    return kRunFailed;
  }
  write_file(std::move(output), format(run, arm.model(), program));
  return kSuccess;
}

}  // namespace

int write_urscript(const ExportOptions& options, OutputFile output) {
  const RobotProgram program = load(options);
  const cell::CellArm& arm = *program.simulation.arm();
  const Pose X_WE = robot::forward_tool(arm.model(), arm.start());
  write_file(std::move(output), control::format_urscript(program.plan, arm.model(), X_WE,
                                                         {options.vacuum_output, options.blow_off_output}));
  return kSuccess;
}

int write_ros_trajectory(const ExportOptions& options, OutputFile output) {
  return write_run(options, std::move(output),
                   [&](const control::JointRun& run, const robot::ArmModel& arm, const RobotProgram& program) {
                     return control::format_ros_trajectory(run, arm, program.plan.settings.tick, options.period);
                   });
}

int write_mc_rtc_csv(const ExportOptions& options, OutputFile output) {
  return write_run(options, std::move(output),
                   [](const control::JointRun& run, const robot::ArmModel& arm, const RobotProgram& program) {
                     return control::format_log_csv(control::make_log(run, arm, program.simulation.scenario().gravity));
                   });
}

int write_mc_rtc_flat(const ExportOptions& options, OutputFile output) {
  return write_run(
      options, std::move(output),
      [](const control::JointRun& run, const robot::ArmModel& arm, const RobotProgram& program) {
        return control::format_log_flat(control::make_log(run, arm, program.simulation.scenario().gravity));
      });
}

}  // namespace snug::app
