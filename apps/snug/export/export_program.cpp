// export of programs: for the controllers of real robots.
#include "apps/snug/export/export.hpp"

#include <cstdio>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/version.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/program_fit.hpp"

namespace snug::app {
namespace {

runs::RobotExport load(const ExportOptions& options) {
  if (options.scenario.empty()) {
    throw InputError("command line", "--scenario", "nothing", "the scenario file with the robot that does the program");
  }
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (!scenario.robot) throw InputError(options.scenario, "robot", "", "a scenario with a robot");
  expect_distinct(files_of(options.scenario, options.changes, scenario), {{"-o", options.output}});
  print_robot_warnings(scenario);
  std::string sequence = options.sequence;
  if (sequence.empty() && !scenario.sequences.empty()) sequence = scenario.sequences.front().name;
  const motion::Program program = motion::load_program(options.input);
  runs::require_fit(scenario, sequence, program);
  cell::SimulationOptions how;
  choose_motion(options.motion, read_file(options.input, "a program file (CSV)"), options.input, how);
  return {scenario,
          sequence,
          program,
          how,
          {options.input, version_text(), layer_of(options.corrections), options.is_unchecked,
           [](const std::string& text) { print_warnings({text}); }}};
}

int write(const ExportOptions& options, OutputFile output, const runs::RobotText& made) {
  if (!made.refusal.empty()) {
    std::fprintf(stderr, "snug: %s\n", made.refusal.c_str());
    return kRunFailed;
  }
  write_file(std::move(output), made.text);
  std::fprintf(stderr, "%s: %s\n", options.output.c_str(), made.summary.c_str());
  return kSuccess;
}

}  // namespace

int write_urscript(const ExportOptions& options, OutputFile output) {
  const runs::RobotExport program = load(options);
  control::UrScriptOptions script = options.script;
  script.io = runs::with_wiring(model::robot_io(program.scenario()), options.wiring);
  return write(options, std::move(output), program.urscript(script, options.from_box));
}

int write_ros_trajectory(const ExportOptions& options, OutputFile output) {
  return write(options, std::move(output), load(options).ros_trajectory(options.period));
}

int write_mc_rtc_csv(const ExportOptions& options, OutputFile output) {
  return write(options, std::move(output), load(options).log_csv());
}

int write_mc_rtc_flat(const ExportOptions& options, OutputFile output) {
  return write(options, std::move(output), load(options).log_flat());
}

}  // namespace snug::app
