// simulate: loads what the options name, runs it, prints what became of it.
#include "apps/snug/simulate/simulate.hpp"
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/csv.hpp"
#include "snug/runs/program_fit.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/run_table.hpp"
#include "snug/study/repeated_runs.hpp"

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
  apply(options.physics, scenario);
  if (options.resume) scenario.initial_state = model::InitialState{*options.resume, options.resume_at};
  if (options.resume_at && !options.resume) {
    throw InputError("command line", "--resume-at", "without --resume", "a recording to continue from");
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
  if (options.physics.cup) run.simulation.cup = cup::cup_mode_of(*options.physics.cup, "command line");
  run.until = options.until;
  run.threads = options.threads.value_or(core_count());
  run.version = version_text();
  run.describe = [](const runs::RunResult& result) { return runs::format_result(result); };
  return run;
}

NamedFiles files_of(const SimulateOptions& options, const model::Scenario& scenario) {
  NamedFiles files = files_of(options.scenario, options.changes, scenario);
  add_file(files, "--program", options.program);
  if (scenario.initial_state) files.push_back({"the recording to continue from", scenario.initial_state->recording});
  return files;
}

namespace {

/// The words that all runs have.
std::vector<std::string> common_words(const SimulateOptions& options, std::uint64_t seed) {
  OptionWords words = words_of(options.changes);
  const auto add = [&](const char* option, const auto& value) {
    if (value) words.emplace_back(option, fmt::format("{}", *value));
  };
  add("--program", options.program);
  add("--sequence", options.sequence);
  add("--controller", options.motion.controller);
  add("--tempo", options.motion.tempo);
  add("--robot", options.robot);
  words.emplace_back("--corrections", options.corrections);
  add("--until", options.until);
  add("--dt", options.physics.dt);
  add("--cup", options.physics.cup);
  add("--record-period", options.physics.record_period);
  words.emplace_back("--seed", std::to_string(seed));
  std::vector<std::string> flat;
  for (const auto& [option, value] : words) flat.insert(flat.end(), {option, value});
  return flat;
}

int run_repeatedly(const SimulateOptions& options, const model::Scenario& scenario, int threads) {
  if (options.record || options.csv) {
    throw InputError("command line", "--monte-carlo", "with --record or --csv", "one of them, or --draw");
  }
  const std::vector<study::RepeatedRun> runs =
      study::repeat_runs(find_scenario(options.scenario), common_words(options, scenario.seed), *options.monte_carlo,
                         threads, [](const std::vector<std::string>& words) { return run_row(words); });
  print(options.json ? study::format_json(runs) : study::format_table(runs));
  const auto failed = std::ranges::count_if(runs, [](const study::RepeatedRun& run) { return !run.failure.empty(); });
  if (failed == 0) return kSuccess;
  std::fprintf(stderr, "snug: failed: %d of %zu runs did not reach their end\n", static_cast<int>(failed), runs.size());
  return kRunFailed;
}

int run_simulate(const SimulateOptions& options) {
  model::Scenario scenario = load_with_overrides(options);
  runs::RunOptions run_options = make_run_options(options, scenario);
  for (const auto& [is_given, option] :
       {std::pair(options.monte_carlo.has_value(), "--monte-carlo"), std::pair(options.draw.has_value(), "--draw")}) {
    if (is_given && !run_options.program) throw InputError("command line", option, "no --program", "a program to run");
  }
  if (options.monte_carlo) return run_repeatedly(options, scenario, run_options.threads);
  if (options.draw) scenario = cell::draw_run(scenario, run_options.sequence, *options.draw);
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

constexpr const char* kSimulateExamples = R"(Examples:
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 -o run.h5
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --corrections seq1 --json
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --monte-carlo 20 --seed 7
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --seed 7 --draw 13 -o worst.h5
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --robot ur10 --csv joints.csv
  snug pack scenarios/box-demonstrator.yaml --container 400x300x200 --sequence 1 --samples 0 --program small.csv
  snug simulate scenarios/box-demonstrator.yaml --container 400x300x200 --program small.csv --sequence 1
  snug simulate scenarios/slide.yaml --until 5 --csv slide.csv)";

}  // namespace

void add_program_options(const Verb& verb, SimulateOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.option("--program", options.program, "FILE.csv", "waypoint file (13 columns) to run; needs --sequence");
  verb.option("--sequence", options.sequence, "NAME", "item sequence of the scenario that the program packs");
  add_motion_words(verb, options.motion);
  verb.option(
      "--robot", options.robot, "NAME",
      "move the tool with the joints of the scenario's robot, such as ur10 (default: the tool moves by itself)");
  add_corrections(verb, options.corrections);
}

void add_physics_options(const Verb& verb, SimulateOptions& options) {
  verb.option("--until", options.until, "SECONDS", "stop at this simulated time; default: the program's end",
              within(1e-6, 1e6));
  add_physics(verb, options.physics);
  verb.option(
      "--threads", options.threads, "N",
      "threads for repeated runs or for a scene of many bodies; they do not change the result (default: all cores)",
      whole(1, kMostThreads));
}

void add_simulate(CLI::App& app, Action& action) {
  const Verb verb(app, action, "simulate", "run a scenario and report what happened to every box", kSimulateExamples);
  SimulateOptions& options = verb.runs(run_simulate);
  add_scenario(verb, options.scenario);
  add_program_options(verb, options);
  add_physics_options(verb, options);
  const OptionRow repeated =
      verb.option("--monte-carlo", options.monte_carlo, "N",
                  "run the program N times in cells drawn from the scenario's `uncertainty`", whole(1, kMostRuns));
  verb.option("--draw", options.draw, "N", "run only the N-th of these draws, for example to record the worst",
              whole(1, kMostRuns))
      .excludes(repeated);
  verb.option("-o,--record", options.record, "FILE.h5", "write a recording");
  verb.option("--resume", options.resume, "FILE.h5",
              "continue a recording of the same bodies from its last frame or from --resume-at; not with --program");
  verb.option("--resume-at", options.resume_at, "SECONDS", "instant from which to continue", positive());
  verb.option("--csv", options.csv, "FILE.csv", "write one table, a row per recorded instant");
  add_json(verb, options.json);
}

}  // namespace snug::app
