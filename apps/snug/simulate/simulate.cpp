// simulate: loads what the options name, runs it, prints what became of it.
#include "apps/snug/simulate/simulate.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/version.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "apps/snug/simulate/repeated_runs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/spin.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/csv.hpp"
#include "snug/runs/program_fit.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/run_table.hpp"

namespace snug::app {
namespace {

/// Writes the table of a run while it goes on.
class TableWriter : public runs::RunObserver {
 public:
  explicit TableWriter(OutputFile file) : file_(std::move(file)) {}
  void begin(const record::RecordingHeader& header) override { writer_.emplace(std::move(file_), header); }
  bool add(const record::Frame& frame) override {
    writer_->append(frame);
    return true;
  }
  void add(const record::Event& /*event*/) override {}
  void close() { writer_->close(); }

 private:
  OutputFile file_;
  std::optional<record::CsvWriter> writer_;
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
  model::check_spins(scenario);
  if (options.seed) scenario.seed = *options.seed;
  if (options.record_period) scenario.record_period = *options.record_period;
  if (options.resume) scenario.initial_state = model::InitialState{*options.resume, options.resume_at};
  if (options.resume_at && !options.resume) {
    throw InputError("command line", "--resume-at", "without --resume", "a recording to go on from");
  }
  return scenario;
}

runs::RunOptions make_run_options(const SimulateOptions& options, const model::Scenario& scenario) {
  runs::RunOptions run;
  if (options.program) {
    run.program_text = read_file(*options.program, "a program file (CSV)");
    run.program = motion::parse_program(run.program_text, *options.program);
    if (!options.sequence) throw InputError("command line", "--sequence", "nothing", list_sequences(scenario));
    print_warnings(runs::find_misfits(scenario, *options.sequence, *run.program));
  } else if (options.robot) {
    throw InputError("command line", "--robot", "'" + *options.robot + "' without --program", "both or none");
  } else if (options.sequence) {
    throw InputError("command line", "--sequence", "'" + *options.sequence + "' without --program", "both or none");
  }
  if (options.sequence) run.sequence = *options.sequence;
  if (options.corrections != "none") run.corrections = options.corrections;
  if (options.robot) {
    run.simulation.robot = *options.robot;
    print_robot_warnings(scenario);
  }
  choose_motion(options.motion, run.program_text, options.program.value_or(""), run.simulation);
  if (options.cup) run.simulation.cup = cup::cup_mode_of(*options.cup, "command line");
  run.until = options.until;
  run.threads = options.threads.value_or(core_count());
  run.version = version_text();
  run.describe = [](const runs::RunResult& result) { return runs::format_result(result); };
  return run;
}

NamedFiles files_of(const SimulateOptions& options, const model::Scenario& scenario) {
  NamedFiles files = files_of(options.scenario, options.changes, scenario);
  add_file(files, "--program", options.program);
  if (scenario.initial_state) files.push_back({"the recording to go on from", scenario.initial_state->recording});
  return files;
}

namespace {

int run_repeatedly(const SimulateOptions& options, const model::Scenario& scenario, int threads) {
  if (options.record || options.csv) {
    throw InputError("command line", "--monte-carlo", "with --record or --csv", "one of them, or --draw");
  }
  const std::vector<RepeatedRun> runs = repeat_runs(options, scenario.seed, *options.monte_carlo, threads);
  print(options.json ? format_json(runs) : format_table(runs));
  const auto failed = std::ranges::count_if(runs, [](const RepeatedRun& run) { return !run.failure.empty(); });
  if (failed == 0) return kSuccess;
  std::fprintf(stderr, "snug: failed: %d of %zu runs did not reach their end\n", static_cast<int>(failed), runs.size());
  return kRunFailed;
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
  model::Scenario scenario = load_with_overrides(options);
  runs::RunOptions run_options = make_run_options(options, scenario);
  for (const auto& [is_given, option] :
       {std::pair(options.monte_carlo.has_value(), "--monte-carlo"), std::pair(options.draw.has_value(), "--draw")}) {
    if (is_given && !run_options.program) throw InputError("command line", option, "no --program", "a program to run");
  }
  if (options.monte_carlo) return run_repeatedly(options, scenario, run_options.threads);
  if (options.draw) scenario = draw_cell(scenario, run_options.sequence, *options.draw);
  NamedFiles outputs;
  add_file(outputs, "-o", options.record);
  add_file(outputs, "--csv", options.csv);
  expect_distinct(files_of(options, scenario), outputs);
  std::optional<OutputFile> record = reserve_recording(options.record);
  if (record) run_options.record_file = &*record;
  std::optional<TableWriter> table;
  if (options.csv) run_options.observer = &table.emplace(OutputFile(*options.csv));
  const runs::RunResult result = runs::run(scenario, run_options);
  if (table) table->close();
  print(options.json ? runs::format_result(result) : format_table(result));
  if (!result.failure) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", result.failure.text.c_str());
  return kRunFailed;
}

}  // namespace snug::app
