// check: loads program and scenario, looks at the way, prints what is in it.
#include "apps/snug/check/check.hpp"

#include <algorithm>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/check_text.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_fit.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::app {
namespace {

/// Whether every pick and something over the container is reached.
int print_reach(const model::Scenario& scenario, bool as_json) {
  const runs::ReachMap map = runs::make_reach_map(scenario, core_count());
  print(as_json ? format_json(map) : format_table(map));
  const auto is_reached = [](const runs::ReachPick& pick) { return pick.point.verdict == runs::ReachVerdict::Reached; };
  return map.counts.front() > 0 && std::ranges::all_of(map.picks, is_reached) ? kSuccess : kRunFailed;
}

}  // namespace

int run_check(const CheckOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (options.maps_reach) {
    print_robot_warnings(scenario);
    return print_reach(scenario, options.json);
  }
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
