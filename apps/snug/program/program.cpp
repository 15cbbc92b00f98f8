// program: loads scenario and placements, writes the program that packs them.
#include "apps/snug/program/program.hpp"

#include <cstdio>

#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/session/task.hpp"

namespace snug::app {

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
  const std::string text = motion::format_program(*program);
  if (output) {
    write_file(std::move(*output), text);
  } else {
    print(text);
  }
  return kSuccess;
}

}  // namespace snug::app
