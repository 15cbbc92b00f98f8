// control: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/control/control.hpp"

namespace snug::app {
namespace {

constexpr const char* kControlExamples = R"(Examples:
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --sequence 1      # in another terminal
  snug control program.csv --click tcp://127.0.0.1:5555 --sequence 1
With the corrections of a site: --corrections seq1. With a simulator that names things as the demonstrator's does:
--object ur10_FTSensor_sr_gripper --vacuum-event gripper.)";

}  // namespace

void add_control(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("control", "do a program with a CLICK simulator in another program");
  const auto options = std::make_shared<ControlOptions>();
  verb.add_option("program", options->program, "waypoint file (13 columns)")->required()->type_name("FILE.csv");
  verb.add_option("--click", options->endpoint, "where the simulator is: tcp://HOST:PORT or ipc://PATH")
      ->type_name("ADDRESS")
      ->capture_default_str();
  verb.add_option("--scenario", options->scenario, "what the controller knows: arm, limits, gains, boxes")
      ->type_name("SCENARIO.yaml")
      ->capture_default_str();
  verb.add_option(
          "--sequence", options->sequence,
          "item sequence that the program packs: its boxes are brought, where the simulator has events for that")
      ->type_name("NAME");
  verb.add_option("--robot", options->robot, "robot of the scenario; absent: the one there is")->type_name("NAME");
  add_motion_words(verb, options->motion);
  verb.add_option("--corrections", options->corrections,
                  "site corrections: a layer of the scenario such as seq1 or seq2-5, or none")
      ->type_name("LAYER")
      ->capture_default_str();
  verb.add_option("--object", options->object, "the simulator's object that is driven; absent: the one with the joints")
      ->type_name("NAME");
  verb.add_option("--vacuum-event", options->vacuum_event, "name of the event that switches the vacuum")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--blow-off-event", options->blow_off_event, "name of the event that switches the blow-off")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--keys", options->keys,
                  "keys by which this program is known there, and knows whom it meets (`snug keys`): a folder, or "
                  "a file NAME.key_secret in it")
      ->type_name("DIR");
  verb.add_option("--timeout", options->patience, "how long to wait for an answer")
      ->check(within(0.01, 1e5))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kControlExamples);
  verb.callback([options, &action] { action = [options] { return run_control(*options); }; });
}

}  // namespace snug::app
