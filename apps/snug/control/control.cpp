// control: a program through the joints of a CLICK simulator, with snug's joint controller.
#include "apps/snug/command_line/verbs.hpp"

#include <cstdio>
#include <optional>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/remote_plant/program_text.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_fit.hpp"

namespace snug::app {
namespace {

struct ControlOptions {
  std::string program;
  std::string endpoint = "tcp://127.0.0.1:5555";
  std::string scenario = "scenarios/box-demonstrator.yaml";  ///< arm, limits, gains, boxes
  std::optional<std::string> sequence;                       ///< whose boxes are brought, whose gain is used
  std::optional<std::string> robot;
  MotionWords motion;
  std::string corrections = "none";
  std::string object = {};
  std::string vacuum_event = "vacuum", blow_off_event = "blow_off";
  ClientWords client;
  bool json = false;
};

int run_control(const ControlOptions& options) {
  model::Scenario scenario = load_changed(options.scenario, {});
  if (!scenario.robot || (options.robot && *options.robot != scenario.robot->name)) {
    throw InputError(
        scenario.source_name, "--robot", "'" + options.robot.value_or("") + "'",
        scenario.robot ? "'" + scenario.robot->name + "', the robot of the scenario" : "a scenario with a robot");
  }
  print_robot_warnings(scenario);
  model::Sequence none;
  const model::Sequence& sequence = options.sequence ? cell::require_sequence(scenario, *options.sequence) : none;
  cell::SimulationOptions how;
  const std::string text = read_file(options.program, "a program file (CSV)");
  choose_motion(options.motion, text, options.program, how);
  cell::limit_joint_speeds(scenario, how.tracking);
  const motion::Program program = motion::parse_program(text, options.program);
  if (options.sequence) print_warnings(runs::find_misfits(scenario, *options.sequence, program));
  const std::string corrections = layer_of(options.corrections);
  motion::PreparedProgram plan =
      cell::prepare(scenario, sequence, how, runs::corrected(scenario, program, corrections));
  std::unique_ptr<const cell::JointPace> pace;
  if (motion::is_fast(how.tracking)) pace = cell::make_joint_pace(scenario, motion::tempo_of(how.tracking));
  plan.path_limits = pace.get();
  const cell::CellArm arm(scenario, plan.settings.task_stiffness);
  remote_plant::ProgramClientSettings settings{options.object, options.vacuum_event, options.blow_off_event,
                                               options.sequence ? &sequence : nullptr, options.client.patience};
  click::Client client(options.endpoint, options.client.patience, click::find_client_keys(options.client.keys));
  const remote_plant::ProgramClientResult result = remote_plant::run_program(client, scenario, arm, plan, settings);
  if (!result.has_begun)
    throw InputError("command line", "--click", result.failure, "the address of a simulator of this robot");
  print(options.json ? remote_plant::format_json(result) : remote_plant::format_table(result));
  if (result.failure.empty()) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", printable(result.failure, kLongestMessage).c_str());
  return kRunFailed;
}

constexpr const char* kControlExamples = R"(Examples:
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --sequence 1      # in another terminal
  snug control program.csv --click tcp://127.0.0.1:5555 --sequence 1
--corrections seq1 applies the corrections of a site. A simulator with the names of the demonstrator's needs
--object ur10_FTSensor_sr_gripper --vacuum-event gripper.)";

}  // namespace

void add_control(CLI::App& app, Action& action) {
  const Verb verb(app, action, "control", "execute a program on a CLICK simulator", kControlExamples);
  ControlOptions& options = verb.runs(run_control);
  verb.option("program", options.program, "FILE.csv", "waypoint file (13 columns)").required();
  verb.option("--click", options.endpoint, "ADDRESS", "address of the simulator: tcp://HOST:PORT or ipc://PATH");
  verb.option("--scenario", options.scenario, "SCENARIO.yaml", "scenario of the controller: arm, limits, gains, boxes");
  verb.option("--sequence", options.sequence, "NAME",
              "item sequence that the program packs; its boxes are brought if the simulator has events for that");
  verb.option("--robot", options.robot, "NAME", "robot of the scenario (default: its only one)");
  add_motion_words(verb, options.motion);
  add_corrections(verb, options.corrections);
  verb.option("--object", options.object, "NAME",
              "object of the simulator to drive (default: the one with the joints)");
  verb.option("--vacuum-event", options.vacuum_event, "NAME", "name of the event that switches the vacuum");
  verb.option("--blow-off-event", options.blow_off_event, "NAME", "name of the event that switches the blow-off");
  add_client(verb, options.client, "--timeout");
  add_json(verb, options.json);
}

}  // namespace snug::app
