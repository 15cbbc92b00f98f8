// check: loads program and scenario, looks at the way, prints what is in it.
#include "apps/snug/check/check.hpp"

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "snug/core/read_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/check_text.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_fit.hpp"

namespace snug::app {

int run_check(const CheckOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  runs::CheckOptions check;
  if (options.sequence) check.sequence = *options.sequence;
  if (options.robot) check.robot = *options.robot;
  const std::string text = read_file(options.program, "a program file (CSV)");
  cell::SimulationOptions how;
  choose_motion(options.motion, text, options.program, how);
  check.tracking = how.tracking;
  print_robot_warnings(scenario);
  const motion::Program read = motion::parse_program(text, options.program);
  if (options.sequence) print_warnings(runs::find_misfits(scenario, *options.sequence, read));
  const motion::Program program =
      runs::corrected(scenario, read, options.corrections == "none" ? "" : options.corrections);
  const runs::CheckResult result = runs::check_program(scenario, program, check);
  print(options.json ? format_json(result) : format_table(result));
  return result.is_ok ? kSuccess : kRunFailed;
}

}  // namespace snug::app
