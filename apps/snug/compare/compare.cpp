// compare: agents x sequences x plants.
#include "apps/snug/command_line/verbs.hpp"
#include "apps/snug/pack/pack.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/study/comparison_design.hpp"
#include "snug/study/run.hpp"

namespace snug::app {
namespace {

/// The words of `snug compare`.
struct CompareOptions {
  PackOptions pack;                ///< scenario, seeds, perception, robot, decision time, threads, samples
  study::ComparisonChoice choice;  ///< of agents, sequences and plants
  bool json = false;
  bool csv = false;
  std::optional<std::string> page;  ///< HTML file
  std::optional<std::string> dir;   ///< folder that keeps the rows, so that the same words go on after a kill
};

/// The words that all sessions have.
OptionWords common_words(const PackOptions& pack, std::uint64_t seed) {
  const PackOptions usual;
  OptionWords words = words_of(pack.changes);
  const auto add = [&](const char* option, const auto& value, const auto& otherwise) {
    if (value != otherwise) words.emplace_back(option, fmt::format("{}", value));
  };
  words.emplace_back("--seed", std::to_string(seed));
  for (const std::string& change : pack.plant_set) words.emplace_back("--plant-set", change);
  add("--perception", pack.plant.perception, usual.plant.perception);
  add("--samples", pack.session.samples, usual.session.samples);
  if (pack.session.skips) words.emplace_back("--skips", std::to_string(*pack.session.skips));
  add("--decision-time", pack.session.decision.time, usual.session.decision.time);
  add("--future", pack.future, usual.future);
  add("--fault", pack.fault, usual.fault);
  add("--controller", pack.controller, usual.controller);
  if (pack.tempo) words.emplace_back("--tempo", fmt::format("{}", *pack.tempo));
  if (pack.robot) words.emplace_back("--robot", *pack.robot);
  return words;
}

/// Prints rows as they come, and how many are done on a terminal.
class Printer {
 public:
  Printer(study::CompareForm form, std::size_t sessions) : form_(form), sessions_(sessions) {}

  void add(const study::SessionRow& row, const std::string& said) {
    if (is_terminal_) std::fputs("\r\033[K", stderr);
    if (!row.is_interrupted()) std::fputs(said.c_str(), stderr);  // else it says only that, as say_end() will
    print_now(study::format_compare_row(form_, row, count_ == 0));
    ++count_;
    if (is_terminal_ && count_ < sessions_) std::fprintf(stderr, "%zu of %zu sessions", count_, sessions_);
    std::fflush(stderr);
  }

 private:
  study::CompareForm form_;
  std::size_t sessions_, count_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

/// The report page of a session's recording, beside it; nothing where nothing was sent, and so nothing recorded.
std::string make_report(const study::SessionRow& row) {
  const std::string& recording = row.point.recording;
  if (recording.empty() || row.items_sent == 0 || !std::filesystem::exists(recording)) return {};
  std::string page = std::filesystem::path(recording).replace_extension(".html").string();
  write_file(OutputFile(page), report::assemble_page(viewer_page(), encode_recordings({recording}, {}, {})));
  return page;
}

/// What went wrong, on standard error; the exit code.
int say_end(const std::vector<study::SessionRow>& rows, std::size_t sessions, std::uint64_t left_out) {
  const auto failed = std::ranges::count_if(rows, [](const study::SessionRow& row) { return !row.failure.empty(); });
  if (is_interrupted()) std::fprintf(stderr, "snug: interrupted after %zu of %zu sessions\n", rows.size(), sessions);
  if (failed > 0) {
    std::fprintf(stderr, "snug: failed: %d of %zu sessions did not finish\n", static_cast<int>(failed), rows.size());
  }
  if (left_out > 0) {
    std::fprintf(stderr,
                 "snug: failed: %llu sessions are missing: their processes were killed, or other processes run them\n",
                 static_cast<unsigned long long>(left_out));
  }
  return failed == 0 && left_out == 0 && !is_interrupted() ? kSuccess : kRunFailed;
}

/// In a process of its own: one session, its recording, its row as JSON. The exit code of `snug pack`.
int run_session(const model::Scenario& scenario, const study::SessionPoint& point, session::SessionOptions session,
                simulated_plant::SimulatedPlantOptions plant) {
  session.agent = point.agent;
  session.ask = choose_ask(point.agent, PackOptions{}.agent_patience);
  plant.seed = point.plant_seed;
  std::optional<OutputFile> recording;
  study::TrialFiles files;
  if (!point.recording.empty()) {
    recording = reserve_recording(point.recording);
    files.recording = study::recording_of(plant, session.agent, version_text(), *recording);
    files.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
  }
  const study::Trial trial = study::run_trial(scenario, point.sequence, session, plant, {}, files);
  print(study::format_row(study::make_row(trial, point)));
  if (!trial.session.failure.text.empty())
    std::fprintf(stderr, "snug: failed: %s\n", trial.session.failure.text.c_str());
  const bool is_whole = trial.session.stop_reason != session::StopReason::Interrupted;
  return flush_stdout() && trial.session.failure.text.empty() && is_whole ? kSuccess : kRunFailed;
}

study::CompareForm form_of(const CompareOptions& options) {
  if (options.json) return study::CompareForm::Json;
  return options.csv ? study::CompareForm::Csv : study::CompareForm::Table;
}

/// The folder of --dir, its files among those that no output may be.
std::optional<study::Folder> open_folder(const CompareOptions& options, const study::Study& study, NamedFiles& inputs) {
  if (!options.dir) return std::nullopt;
  std::optional<study::Folder> folder(std::in_place, study, *options.dir, true);
  for (const std::filesystem::path& file : folder->files()) inputs.push_back({"a file of --dir", file});
  return folder;
}

int run_compare(const CompareOptions& options) {
  model::Scenario scenario = load_changed(options.pack.scenario, options.pack.changes);
  study::ComparisonChoice choice = options.choice;
  choice.plant_seed = options.pack.plant.seed;
  const study::ComparisonDesign design = study::design_comparison(choice, scenario);
  const std::vector<study::SessionPoint>& points = design.points;
  session::SessionOptions session = make_session_options(options.pack, scenario);
  const simulated_plant::SimulatedPlantOptions plant = make_plant_options(options.pack, session);
  for (const std::string& agent : design.agents)
    (void)choose_ask(agent, PackOptions{}.agent_patience);  // it can be had
  const std::uint64_t seed = session.decision.seed;
  const study::Study study =
      study::make_comparison_study(choice, options.pack.scenario, common_words(options.pack, seed), points);
  NamedFiles inputs = files_of(options.pack.scenario, options.pack.changes, scenario);
  expect_distinct(inputs, options.page ? NamedFiles{{"-o", *options.page}} : NamedFiles{});  // before a folder is made
  const std::optional<study::Folder> folder = open_folder(options, study, inputs);
  std::optional<OutputFile> page = reserve(inputs, options.page);
  if (choice.recordings) make_folder("--runs", *choice.recordings);
  catch_interrupts();
  std::fprintf(stderr, "snug: %zu sessions: %zu agents, %zu sequences, %d plants\n", points.size(),
               design.agents.size(), design.sequences.size(), choice.plants);
  const study::CompareForm form = form_of(options);
  print_now(study::format_compare_head(form));

  std::vector<study::ComparedSession> sessions;
  Printer printer(form, points.size());
  study::RunSettings settings;
  settings.version = version_text();
  settings.processes = static_cast<int>(std::min(static_cast<std::size_t>(session.threads), points.size()));
  session.threads = session.decision.threads = session.threads / settings.processes;
  settings.is_stopped = is_interrupted;
  settings.tell = [&](const study::RowResult& result, const std::string& said) {
    if (result.exit_code == kBadInput)
      throw InputError(study.source, "row " + std::to_string(result.row), result.error, "a session that can be run");
    const study::SessionRow row = study::read_row(result, points[result.row], seed);
    sessions.push_back({row, study::command_of(study, study::row_of(study, result.row)), {}});
    printer.add(row, said);
    sessions.back().report = make_report(row);
  };
  const study::RowWork work = [&](std::uint64_t row) { return run_session(scenario, points[row], session, plant); };
  const study::RunSummary summary = study::run_rows(study, folder ? &*folder : nullptr, work, settings);

  std::vector<study::SessionRow> rows;
  for (const study::ComparedSession& one : sessions) rows.push_back(one.row);
  if (page) write_file(std::move(*page), study::format_compare_page(scenario, sessions, *options.page));
  const bool is_own_container = !options.pack.changes.container && !options.pack.changes.pallet;
  print_now(study::format_compare_end(form, scenario, rows, is_own_container));
  return say_end(rows, points.size(), summary.left_out);
}

constexpr const char* kCompareExamples = R"(Examples:
  snug compare scenarios/box-demonstrator.yaml --agents contact-aware --plants 6 -o compare.html --runs runs
  snug compare scenarios/box-demonstrator.yaml --sequences 1,3 --agents margin,contact-aware --json
  snug compare scenarios/box-demonstrator.yaml --decision-time 0.2 --plants 3 --csv > rows.csv
  snug compare scenarios/box-demonstrator.yaml --random 50 --agents contact-aware --dir random
  snug compare scenarios/box-demonstrator.yaml --container 400x300x200 --agents contact-aware)";

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  const Verb verb(app, action, "compare", "compare agents over sequences and plants: filling, losses, recoveries",
                  kCompareExamples);
  CompareOptions& options = verb.runs(run_compare);
  add_scenario(verb, options.pack.scenario);
  verb.option("--sequences", options.choice.sequences, "NAMES",
              "all, or names separated by commas (default: all; with --random none but the random ones)");
  const OptionRow random = verb.option("--random", options.choice.random, "N",
                                       "number of additional sequences random-1, ...: every box of the scenario in "
                                       "random order, each packed in plants of its own",
                                       whole(1, 10000));
  verb.option("--random-seed", options.choice.random_seed, "N", "seed of their order", whole(0)).needs(random);
  verb.option("--agents", options.choice.agents, "NAMES",
              "all built-in ones, or names separated by commas; module:Class names one in Python");
  verb.option("--plants", options.choice.plants, "N",
              "number of plants that every agent packs with every sequence: the seed --plant-seed and those after it",
              whole(1, kMostRuns));
  add_packing_options(verb, options.pack);
  const OptionRow json = verb.flag("--json", options.json, "print rows as JSON");
  verb.flag("--csv", options.csv, "print rows as CSV").excludes(json);
  verb.option("-o,--output", options.page, "FILE.html",
              "write a page: charts by agent, sequence and plant, each container, the command of each run");
  verb.option("--runs", options.choice.recordings, "DIR",
              "write a recording and a report page of every session into this folder; the page of -o links to them");
  verb.option("--dir", options.dir, "DIR",
              "keep every row in this folder, so that the same command continues after a kill; DIR/study.yaml is the "
              "comparison as a study (snug study status|merge|report)");
}

}  // namespace snug::app
