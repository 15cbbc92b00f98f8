// program: loads scenario and placements, writes the program that packs them.
#include "program.hpp"

#include <cstdio>

#include "snug/cell/task.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::app {

int run_program(const ProgramOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (!options.sequence) throw InputError("command line", "--sequence", "nothing", "a sequence of the scenario");
  const auto placements = model::load_placements(options.placements, scenario);
  const auto program = cell::make_program(scenario, *options.sequence, placements, options.placements);
  if (!program) {
    std::fprintf(stderr, "snug: no program: %s\n", program.error().text.c_str());
    return kRunFailed;
  }
  if (options.output) {
    motion::write_program(*program, *options.output);
  } else {
    std::fputs(motion::format_program(*program).c_str(), stdout);
  }
  return kSuccess;
}

}  // namespace snug::app
