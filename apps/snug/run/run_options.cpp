// run: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/run/run.hpp"

namespace snug::app {
namespace {

constexpr const char* kRunExamples =
    R"(Outputs 0 and 1 are vacuum and blow-off, input 0 says that the vacuum is reached, input 1 that a box stands at the aligner.
Popups are closed at once. Exit code 0: the program came to its end; 1: it failed, was stopped, or the cell did; 2: the input cannot be used.
Examples:
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript -o program.script
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1 --skip BOX024,BOX025
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1 --model ur10e -o run.h5 --json)";

}  // namespace

void add_run(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("run", "run a URScript program on the simulated cell");
  const auto options = std::make_shared<RunOptions>();
  ServeOptions& cell = options->cell;
  verb.add_option("program", options->program, "URScript program")->required()->type_name("PROGRAM.script");
  verb.add_option("scenario", cell.scenario, "scenario file with a robot, or name of one that comes with snug")
      ->required()
      ->type_name("SCENARIO.yaml");
  add_scenario_changes(verb, cell.changes);
  verb.add_option("--sequence", cell.sequence, "item sequence whose boxes come to the aligner; absent: the first")
      ->type_name("NAME");
  verb.add_option("--skip", cell.skipped,
                  "boxes of the sequence that do not come, with commas between: those that the session left out")
      ->delimiter(',')
      ->type_name("BOXES");
  verb.add_option("--plant-seed", cell.plant_seed,
                  "run it in the plant that `snug pack --plant-seed N` packs: drawn from the scenario's `uncertainty`")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--model", cell.ur.model, "of the controller: ur10 has a period of 8 ms, the others 2 ms")
      ->check(one_of({"ur10", "ur10e", "ur5e"}))
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--until", options->until, "stop the program at this simulated time")
      ->check(within(0.0, 86400.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("-o,--record", cell.record, "write a recording")->type_name("FILE.h5");
  verb.add_flag("--json", cell.json, "print the result as JSON");
  verb.footer(kRunExamples);
  verb.callback([options, &action] { action = [options] { return run_script(*options); }; });
}

}  // namespace snug::app
