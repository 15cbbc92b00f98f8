// program: turns a list of placements into a program of plain pick-and-place waypoints.
#include "apps/snug/command_line/verbs.hpp"

#include <cstdio>
#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/session/task.hpp"

namespace snug::app {
namespace {

struct ProgramOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::string placements;
  std::optional<std::string> sequence;  ///< required: how each box stands at the aligner
  std::optional<std::string> output;    ///< absent: stdout
};

int run_program(const ProgramOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (!options.sequence) throw InputError("command line", "--sequence", "nothing", "a sequence of the scenario");
  NamedFiles inputs = files_of(options.scenario, options.changes, scenario);
  add_file(inputs, "the placements", options.placements);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const auto placements = model::load_placements(find_shipped(options.placements), scenario);
  const auto program = session::make_program(scenario, *options.sequence, placements, options.placements);
  if (!program) {
    std::fprintf(stderr, "snug: no program: %s\n", program.error().text.c_str());
    return kRunFailed;
  }
  print_or_write(motion::format_program(*program), std::move(output));
  return kSuccess;
}

}  // namespace

void add_program(CLI::App& app, Action& action) {
  const Verb verb(app, action, "program", "turn placements into a program of waypoints",
                  "Example:\n  snug program scenarios/box-demonstrator.yaml scenarios/demo-placements.yaml --sequence "
                  "1 -o program.csv");
  ProgramOptions& options = verb.runs(run_program);
  add_scenario(verb, options.scenario);
  verb.option("placements", options.placements, "PLACEMENTS.yaml", "boxes and where each shall rest in the container")
      .required();
  verb.option("--sequence", options.sequence, "NAME",
              "item sequence of the scenario: how each box stands at the aligner");
  add_scenario_changes(verb, options.changes);
  verb.option("-o,--output", options.output, "FILE.csv", "file to write; default: stdout");
}

}  // namespace snug::app
