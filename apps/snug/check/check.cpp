// check: whether the robot can do a program, and where it can stand at all, before anything moves.
#include "apps/snug/command_line/verbs.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/check_text.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_fit.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::app {
namespace {

struct CheckOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::string program;  ///< empty with `maps_reach`
  bool maps_reach = false;
  std::optional<std::string> sequence;
  std::optional<std::string> robot;
  MotionWords motion;
  std::string corrections = "none";
  bool json = false;
};

/// Whether every pick and something over the container is reached.
int print_reach(const model::Scenario& scenario, bool as_json) {
  const runs::ReachMap map = runs::make_reach_map(scenario, core_count());
  print(as_json ? format_json(map) : format_table(map));
  const auto is_reached = [](const runs::ReachPick& pick) { return pick.point.verdict == runs::ReachVerdict::Reached; };
  return map.counts.front() > 0 && std::ranges::all_of(map.picks, is_reached) ? kSuccess : kRunFailed;
}

int run_check(const CheckOptions& options) {
  if (options.program.empty() && !options.maps_reach)
    throw InputError("command line", "--program, --reach", "none of them", "one");
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
  const motion::Program program = runs::corrected(scenario, read, layer_of(options.corrections));
  const runs::CheckResult result = runs::check_program(scenario, program, check);
  print(options.json ? format_json(result) : format_table(result));
  return result.is_ok ? kSuccess : kRunFailed;
}

constexpr const char* kCheckExamples =
    R"(check moves the arm with its controller and limits as a run does, but without contact, and tests the whole path: reach,
joint limits and speeds, singularities, collisions between links, and of links, gripper, cup and held box with everything
that stands in the cell. No sensor ends a motion: waypoints of a fast program go to their end. Exported programs move as with exact.
Collision margins are distances, negative inside; the allowed depth of cup and held box is printed beside them. Waypoints
with the same finding share one line. Exit code 0: nothing is in the way; 1: something is; 2: the input cannot be used.
With --reach, check tests poses of a grid over the container and those of the picks in the same way. The tool reaches a
pose if one branch of the arm's inverse passes; paths are not tested. Exit code 1: the tool does not reach a pick, or no
place over the container.
Examples:
  snug check scenarios/box-demonstrator.yaml --program program.csv --sequence 1
  snug check scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --controller exact --json
  snug check scenarios/box-demonstrator.yaml --reach
  snug check scenarios/box-demonstrator.yaml --reach --set "robot.pose={position: [0.2, 0, 0], yaw_deg: 180}" --json)";

}  // namespace

void add_check(CLI::App& app, Action& action) {
  const Verb verb(app, action, "check", "check whether the robot can execute a program, and what is in its way",
                  kCheckExamples);
  CheckOptions& options = verb.runs(run_check);
  add_robot_scenario(verb, options.scenario);
  add_scenario_changes(verb, options.changes);
  const OptionRow program = verb.option("--program", options.program, "FILE.csv", "waypoint file (13 columns)");
  verb.flag("--reach", options.maps_reach,
            "instead of a program: map where the tool can stand, pointing down, over the container and at the picks, "
            "and what keeps it from the other places")
      .excludes(program);
  verb.option("--sequence", options.sequence, "NAME", "item sequence, to check the held boxes as well");
  verb.option("--robot", options.robot, "NAME", "name of the scenario's robot (default: its only one)");
  add_motion_words(verb, options.motion);
  add_corrections(verb, options.corrections);
  add_json(verb, options.json);
}

}  // namespace snug::app
