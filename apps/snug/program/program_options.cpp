// program: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/program/program.hpp"

namespace snug::app {

void add_program(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("program", "turn placements into a program of waypoints");
  const auto options = std::make_shared<ProgramOptions>();
  verb.add_option("scenario", options->scenario,
                  "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      ->required()
      ->type_name("SCENARIO.yaml");
  verb.add_option("placements", options->placements, "boxes and where each shall rest in the container")
      ->required()
      ->type_name("PLACEMENTS.yaml");
  verb.add_option("--sequence", options->sequence, "item sequence of the scenario: how each box stands at the aligner")
      ->type_name("NAME");
  add_scenario_changes(verb, options->changes);
  verb.add_option("-o,--output", options->output, "file to write; default: stdout")->type_name("FILE.csv");
  verb.footer(
      "Example:\n  snug program scenarios/box-demonstrator.yaml scenarios/demo-placements.yaml --sequence 1 -o "
      "program.csv");
  verb.callback([options, &action] { action = [options] { return run_program(*options); }; });
}

}  // namespace snug::app
