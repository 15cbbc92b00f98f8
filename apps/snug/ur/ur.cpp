// ur: what a UR controller says of itself, and whether it fits a scenario's robot. Nothing is moved.
#include "apps/snug/command_line/verbs.hpp"

#include <string>
#include <vector>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/remote_ur/report_text.hpp"
#include "snug/remote_ur/rtde_link.hpp"

namespace snug::app {
namespace {

struct UrCheckOptions {
  std::string address;
  std::string scenario = "scenarios/box-demonstrator.yaml";
  ScenarioChanges changes;
  double patience = 5.0;
  double tolerance_mm = 1.0;
  bool json = false;
};

int run_ur_check(const UrCheckOptions& options) {
  const std::string file = find_shipped(options.scenario);
  const model::Scenario scenario = load_changed(file, options.changes);
  if (!scenario.robot) throw InputError(file, "robot", "nothing", "a scenario with a robot");
  const bool is_whole = options.address.starts_with("ur://");
  remote_ur::Endpoint endpoint = *remote_ur::endpoint_of_ur((is_whole ? "" : "ur://") + options.address, "HOST");
  endpoint.patience = options.patience;
  const remote_ur::RobotReport robot = remote_ur::read_robot(endpoint);
  remote_ur::Tolerances tolerances;
  tolerances.position = 1e-3 * options.tolerance_mm;
  const std::vector<remote_ur::Finding> findings = remote_ur::compare_robot(robot, scenario, tolerances);
  print(options.json ? remote_ur::format_json(robot, findings)
                     : remote_ur::format_text(robot, findings, model::robot_io(scenario)));
  return remote_ur::fits(findings) ? kSuccess : kRunFailed;
}

constexpr const char* kUrCheckHelp =
    R"(check reads the primary port, RTDE and the dashboard. It moves and switches nothing. Exit code 0: the UR fits; 1: something
does not, and what to set is printed; 2: nobody answers, or the input cannot be used.
Example:
  snug serve scenarios/box-demonstrator.yaml --ur 127.0.0.1     # a simulated one, in another terminal
  snug ur check 127.0.0.1 --scenario scenarios/box-demonstrator.yaml)";

}  // namespace

void add_ur(CLI::App& app, Action& action) {
  const Verb verb(app, action, "ur", "query a robot of Universal Robots",
                  "`snug ur check --help` says what it reads. Example:\n  snug ur check --help");
  const Verb part =
      verb.part("check", "report what of a UR does not fit the scenario's robot, and what to set", kUrCheckHelp);
  UrCheckOptions& options = part.runs(run_ur_check);
  part.option("host", options.address, "HOST",
              "IPv4 address or name of the controller; HOST:N adds N to its ports; ur:// may stand before either, as "
              "in `snug pack --plant`")
      .required();
  part.option("--scenario", options.scenario, "SCENARIO.yaml", "scenario with the robot to compare with");
  add_scenario_changes(part, options.changes);
  part.option("--tolerance", options.tolerance_mm, "MM",
              "how far the tool's end may be off, by the controller's kinematics and by its TCP", positive());
  part.option("--timeout", options.patience, "SECONDS", "how long to wait for an answer", within(0.01, 1e5));
  add_json(part, options.json);
}

}  // namespace snug::app
