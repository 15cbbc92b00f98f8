// ur: what a UR controller says of itself, and whether it fits a scenario's robot. Nothing is moved.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/robot_io.hpp"
#include "snug/remote_ur/compare_robot.hpp"
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

using Json = nlohmann::ordered_json;
using remote_ur::Finding;
using remote_ur::Verdict;

const char* verdict_word(Verdict verdict) {
  return verdict == Verdict::Fits ? "fits" : verdict == Verdict::Differs ? "differs" : "unknown";
}

std::string software_text(const remote_ur::RobotReport& robot) {
  return fmt::format("{}.{}.{}.{}", robot.version[0], robot.version[1], robot.version[2], robot.version[3]);
}

/// "0, 1" of the bits that are on; "none".
std::string bits_text(std::uint32_t bits) {
  std::string text;
  for (unsigned bit = 0; bit < 32; ++bit)
    if (((bits >> bit) & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : ", ", bit);
  return text.empty() ? "none" : text;
}

/// "vacuum             standard output 0: off"
void print_signal(const char* name, const std::optional<model::DigitalIo>& io, const char* what, std::uint32_t bits) {
  constexpr std::array kKinds = {"standard", "configurable", "tool"};
  if (!io) return fmt::print("{:18} not wired\n", name);
  const bool is_on = (((bits >> io->bit()) & 1U) != 0) != io->active_low;
  fmt::print("{:18} {} {} {}: {}{}\n", name, kKinds[static_cast<std::size_t>(io->kind)], what, io->number,
             is_on ? "on" : "off", io->active_low ? " (active low)" : "");
}

/// What the scenario's `robot.io` calls them.
void print_signals(const remote_ur::RobotReport& robot, const model::RobotIo& io) {
  print_signal("vacuum", io.vacuum, "output", robot.state.digital_outputs);
  print_signal("blow-off", io.blow_off, "output", robot.state.digital_outputs);
  print_signal("next part", io.next_part, "output", robot.state.digital_outputs);
  print_signal("vacuum reached", io.vacuum_reached, "input", robot.state.digital_inputs);
  print_signal("part present", io.part_present, "input", robot.state.digital_inputs);
  const auto& gauge = io.vacuum_gauge;
  if (gauge && gauge->kind == model::AnalogKind::Tool && gauge->number == 0 && robot.tool_voltage)
    fmt::print("{:18} {:.1f} kPa\n", "vacuum gauge", 1e-3 * gauge->pressure_of(*robot.tool_voltage) + 0.0);
}

void print_text(const remote_ur::RobotReport& robot, const std::vector<Finding>& findings, const model::RobotIo& io) {
  fmt::print("model              {}, software {}\n", robot.model.empty() ? "not told" : robot.model,
             software_text(robot));
  fmt::print("outputs that are on {}\n", bits_text(robot.state.digital_outputs));
  fmt::print("inputs that are on  {}\n", bits_text(robot.state.digital_inputs));
  if (robot.tool_voltage) fmt::print("tool analog input 0 {:.2f} V\n", *robot.tool_voltage);
  print_signals(robot, io);
  fmt::print("\n");
  for (const Finding& finding : findings) {
    fmt::print("{:8} {:15} {}", verdict_word(finding.verdict), finding.what, finding.robot);
    if (finding.verdict != Verdict::Fits) fmt::print("; needed: {}\n{:25}{}", finding.expected, "", finding.remedy);
    fmt::print("\n");
  }
}

Json json_of(const remote_ur::RobotReport& robot, const std::vector<Finding>& findings, bool fits) {
  Json json = {{"fits", fits},
               {"model", robot.model},
               {"version", software_text(robot)},
               {"robot_mode", ur::robot_mode_name(robot.state.robot_mode)},
               {"safety_mode", ur::safety_mode_name(robot.state.safety_mode)},
               {"digital_inputs", robot.state.digital_inputs},
               {"digital_outputs", robot.state.digital_outputs},
               {"joints", robot.q},
               {"findings", Json::array()}};
  for (const Finding& finding : findings)
    json["findings"].push_back({{"what", finding.what},
                                {"verdict", verdict_word(finding.verdict)},
                                {"robot", finding.robot},
                                {"expected", finding.expected},
                                {"remedy", finding.remedy}});
  return json;
}

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
  const std::vector<Finding> findings = remote_ur::compare_robot(robot, scenario, tolerances);
  const bool fits = std::ranges::count(findings, Verdict::Differs, &Finding::verdict) == 0;
  if (options.json) {
    fmt::print("{}\n", json_of(robot, findings, fits).dump());
  } else {
    print_text(robot, findings, model::robot_io(scenario));
  }
  return fits ? kSuccess : kRunFailed;
}

constexpr const char* kUrCheckHelp =
    R"(Reads the primary port, RTDE and the dashboard; moves nothing and switches nothing. Exit code 0: it fits; 1: something
does not, with what to set; 2: nobody answers there, or the input cannot be used.
Example:
  snug serve scenarios/box-demonstrator.yaml --ur 127.0.0.1     # a simulated one, in another terminal
  snug ur check 127.0.0.1 --scenario scenarios/box-demonstrator.yaml)";

}  // namespace

void add_ur(CLI::App& app, Action& action) {
  const Verb verb(app, action, "ur", "ask a robot of Universal Robots",
                  "`snug ur check --help` says what is read. Example:\n  snug ur check --help");
  const Verb part = verb.part("check", "what of a UR does not fit the scenario's robot, and what to set", kUrCheckHelp);
  UrCheckOptions& options = part.runs(run_ur_check);
  part.option(
          "host", options.address, "HOST",
          "IPv4 address or name of the controller; HOST:N, with N added to its ports; or ur:// before either, as of "
          "`snug pack --plant`")
      .required();
  part.option("--scenario", options.scenario, "SCENARIO.yaml", "whose robot it is to be");
  add_scenario_changes(part, options.changes);
  part.option("--tolerance", options.tolerance_mm, "MM",
              "how far the tool's end may be off by the controller's kinematics, and the TCP", positive());
  part.option("--timeout", options.patience, "SECONDS", "how long to wait for an answer", within(0.01, 1e5));
  add_json(part, options.json);
}

}  // namespace snug::app
