// run: a Scenario and what to do with it in, what became of everything out. The first file to read.
#include "snug/runs/run.hpp"

#include "snug/runs/internal/program_run.hpp"

namespace snug::runs {

RunResult run(const model::Scenario& scenario, const RunOptions& options) {
  RunResult result =
      options.program ? internal::run_program(scenario, options) : internal::run_scene(scenario, options);
  result.warnings.insert(result.warnings.begin(), scenario.warnings.begin(), scenario.warnings.end());
  return result;
}

}  // namespace snug::runs
