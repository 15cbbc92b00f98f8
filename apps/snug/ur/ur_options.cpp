// ur: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/ur/ur.hpp"

namespace snug::app {
namespace {

constexpr const char* kUrCheckHelp =
    R"(Reads the primary port, RTDE and the dashboard; moves nothing and switches nothing. Exit code 0: it fits; 1: something
does not, with what to set; 2: nobody answers there, or the input cannot be used.
Example:
  snug serve scenarios/box-demonstrator.yaml --ur 127.0.0.1     # a simulated one, in another terminal
  snug ur check 127.0.0.1 --scenario scenarios/box-demonstrator.yaml)";

}  // namespace

void add_ur(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("ur", "ask a robot of Universal Robots");
  verb.require_subcommand(1);
  CLI::App& part = *verb.add_subcommand("check", "what of a UR does not fit the scenario's robot, and what to set");
  const auto options = std::make_shared<UrCheckOptions>();
  part.add_option("host", options->host, "IPv4 address or name of the controller")->required()->type_name("HOST");
  part.add_option("--scenario", options->scenario, "whose robot it is to be")
      ->type_name("SCENARIO.yaml")
      ->capture_default_str();
  add_scenario_changes(part, options->changes);
  part.add_option("--ur-port-offset", options->port_offset, "added to each port, as that of `snug serve --ur`")
      ->check(whole(0, 35531))
      ->type_name("N")
      ->capture_default_str();
  part.add_option("--tolerance", options->tolerance_mm,
                  "how far the tool's end may be off by the controller's kinematics, and the TCP")
      ->check(positive())
      ->type_name("MM")
      ->capture_default_str();
  part.add_option("--timeout", options->patience, "how long to wait for an answer")
      ->check(within(0.01, 1e5))
      ->type_name("SECONDS")
      ->capture_default_str();
  part.add_flag("--json", options->json, "print JSON");
  part.footer(kUrCheckHelp);
  part.callback([options, &action] { action = [options] { return run_ur_check(*options); }; });
  verb.footer("`snug ur check --help` says what is read. Example:\n  snug ur check --help");
}

}  // namespace snug::app
