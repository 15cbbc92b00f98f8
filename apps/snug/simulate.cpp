// simulate: loads what the options name, runs it, prints what became of it.
#include "simulate.hpp"

#include <cstdio>
#include <filesystem>

#include "run_report.hpp"
#include "snug/cell/ensemble.hpp"
#include "snug/cell/run.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/csv.hpp"
#include "snug/record/reader.hpp"

namespace snug::app {
namespace {

/// A recording that is needed only to make a table of it; gone when this goes.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

 private:
  std::filesystem::path path_;
};

std::string list_sequences(const model::Scenario& scenario) {
  std::string names;
  for (const model::Sequence& sequence : scenario.sequences) names += (names.empty() ? "" : ", ") + sequence.name;
  return names.empty() ? "a scenario with sequences" : "one of " + names;
}

}  // namespace

model::Scenario load_with_overrides(const SimulateOptions& options) {
  model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (options.dt) scenario.time_step = *options.dt;
  if (options.seed) scenario.seed = *options.seed;
  return scenario;
}

cell::RunOptions make_run_options(const SimulateOptions& options, const model::Scenario& scenario) {
  cell::RunOptions run;
  if (options.program) {
    run.program_text = read_file(*options.program, "a program file (CSV)");
    run.program = motion::parse_program(run.program_text, *options.program);
    if (!options.sequence) throw InputError("command line", "--sequence", "nothing", list_sequences(scenario));
  } else if (options.robot) {
    throw InputError("command line", "--robot", "'" + *options.robot + "' without --program", "both or none");
  } else if (options.sequence) {
    throw InputError("command line", "--sequence", "'" + *options.sequence + "' without --program", "both or none");
  }
  if (options.sequence) run.sequence = *options.sequence;
  if (options.corrections != "none") run.corrections = options.corrections;
  if (options.robot) run.simulation.robot = *options.robot;
  if (options.controller == "ideal") run.simulation.controller = motion::ControllerKind::Ideal;
  if (options.cup) run.simulation.cup = *options.cup == "holding" ? cup::CupMode::Holding : cup::CupMode::Phases;
  run.until = options.until;
  run.version = SNUG_VERSION;
  run.describe = [](const cell::RunResult& result) { return format_json(result); };
  if (options.record) run.record_path = *options.record;
  return run;
}

int run_simulate(const SimulateOptions& options) {
  const model::Scenario scenario = load_with_overrides(options);
  cell::RunOptions run_options = make_run_options(options, scenario);
  if (options.ensemble) {
    if (!run_options.program) throw InputError("command line", "--ensemble", "no --program", "a program to run");
    if (options.record || options.csv) {
      throw InputError("command line", "--ensemble", "with --record or --csv", "one of them");
    }
    const cell::EnsembleResult result =
        cell::run_ensemble(scenario, run_options, {*options.ensemble, scenario.seed, options.threads, {}});
    std::fputs((options.json ? format_json(result) : format_table(result)).c_str(), stdout);
    return kSuccess;
  }
  std::optional<TemporaryFile> temporary;
  if (options.csv && !options.record) {
    run_options.record_path = *options.csv + ".part.h5";
    temporary.emplace(run_options.record_path);
  }
  const cell::RunResult result = cell::run(scenario, run_options);
  if (options.csv) record::write_csv(record::load_recording(run_options.record_path), *options.csv);
  std::fputs((options.json ? format_json(result) : format_table(result)).c_str(), stdout);
  if (result.failure.empty()) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", result.failure.c_str());
  return kRunFailed;
}

}  // namespace snug::app
