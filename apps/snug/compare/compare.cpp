// compare: agents x sequences x plants.
#include "apps/snug/compare/compare.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "apps/snug/command_line/interrupt.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/program_motion.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/compare/compare_page.hpp"
#include "apps/snug/compare/compare_report.hpp"
#include "apps/snug/compare/compare_study.hpp"
#include "apps/snug/report/report.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/packing/python_agent.hpp"
#include "snug/study/run.hpp"

namespace snug::app {
namespace {

/// "all" or a list, each checked against what there is.
std::vector<std::string> choose(const std::string& words, const std::vector<std::string>& known, const char* key,
                                bool may_be_python = false) {
  if (words == "all") return known;
  std::vector<std::string> chosen;
  std::stringstream text(words);
  for (std::string word; std::getline(text, word, ',');) {
    if (std::ranges::find(known, word) == known.end() && !(may_be_python && packing::is_python_agent(word))) {
      throw InputError("command line", key, "'" + word + "'", fmt::format("all, or of {}", fmt::join(known, ", ")));
    }
    chosen.push_back(word);
  }
  if (chosen.empty()) throw InputError("command line", key, "nothing", "all, or names separated by commas");
  return chosen;
}

/// Adds sequences of every box of the scenario, in random order; their names.
std::vector<std::string> add_random_sequences(model::Scenario& scenario, int count, std::uint64_t seed) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) {
    names.push_back("random-" + std::to_string(i));
    scenario.sequences.push_back(draw_order(scenario, names.back(), seed));
  }
  return names;
}

std::vector<std::string> choose_sequences(const CompareOptions& options, model::Scenario& scenario) {
  std::vector<std::string> known;
  for (const model::Sequence& sequence : scenario.sequences) known.push_back(sequence.name);
  std::vector<std::string> chosen;
  if (options.sequences || options.random == 0)
    chosen = choose(options.sequences.value_or("all"), known, "--sequences");
  for (std::string& name : add_random_sequences(scenario, options.random, options.random_seed)) {
    chosen.push_back(std::move(name));
  }
  return chosen;
}

/// Every agent packs every sequence in every plant; random sequences in plants of their own.
std::vector<SessionPoint> list_sessions(const CompareOptions& options, const std::vector<std::string>& agents,
                                        const std::vector<std::string>& sequences) {
  const std::size_t plants = static_cast<std::size_t>(options.plants);
  const std::size_t given = sequences.size() - static_cast<std::size_t>(options.random);
  const std::size_t count = agents.size() * sequences.size() * plants;
  if (count > kMostSessions) {
    throw InputError("command line", "sessions", std::to_string(count),
                     fmt::format("at most {}; `snug study` runs more (docs/studies.md)", kMostSessions));
  }
  std::vector<SessionPoint> points;
  for (const std::string& agent : agents) {
    for (std::size_t i = 0; i < sequences.size(); ++i) {
      const std::size_t first = i > given ? (i - given) * plants : 0;
      for (std::size_t plant = 0; plant < plants; ++plant) {
        points.push_back({agent, sequences[i], options.pack.plant_seed + first + plant, i >= given});
      }
    }
  }
  return points;
}

/// What no session could use is said before the first one.
void check_words(const PackOptions& pack, const std::vector<std::string>& agents) {
  (void)make_plant_options(pack, {});
  refuse_tempo_without_fast(pack.tempo, pack.controller);
  for (const std::string& agent : agents) {
    if (packing::is_python_agent(agent)) (void)packing::start_python_agent(agent, agent_script());
  }
}

/// Prints rows as they come, and how many are done on a terminal.
class Printer {
 public:
  Printer(CompareForm form, std::size_t sessions) : form_(form), sessions_(sessions) {}

  void add(const CompareRow& row, const std::string& said) {
    if (is_terminal_) std::fputs("\r\033[K", stderr);
    if (!row.is_interrupted()) std::fputs(said.c_str(), stderr);  // else it says only that, as say_end() will
    print_now(format_compare_row(form_, row, count_ == 0));
    ++count_;
    if (is_terminal_ && count_ < sessions_) std::fprintf(stderr, "%zu of %zu sessions", count_, sessions_);
    std::fflush(stderr);
  }

 private:
  CompareForm form_;
  std::size_t sessions_, count_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

/// The report page of a session's recording, beside it; nothing where nothing was sent, and so nothing recorded.
std::string make_report(const std::string& recording, const CompareRow& row) {
  if (row.items_sent == 0 || !std::filesystem::exists(recording)) return {};
  ReportOptions report;
  report.recordings = {recording};
  report.output = std::filesystem::path(recording).replace_extension(".html").string();
  (void)run_report(report);
  return report.output;
}

/// What went wrong, on standard error; the exit code.
int say_end(const std::vector<CompareRow>& rows, std::size_t sessions, std::uint64_t left_out) {
  const auto failed = std::ranges::count_if(rows, [](const CompareRow& row) { return !row.failure.empty(); });
  if (is_interrupted()) std::fprintf(stderr, "snug: interrupted after %zu of %zu sessions\n", rows.size(), sessions);
  if (failed > 0) {
    std::fprintf(stderr, "snug: failed: %d of %zu sessions did not reach their end\n", static_cast<int>(failed),
                 rows.size());
  }
  if (left_out > 0) {
    std::fprintf(stderr, "snug: failed: %llu sessions were left out: their processes were killed, or others do them\n",
                 static_cast<unsigned long long>(left_out));
  }
  return failed == 0 && left_out == 0 && !is_interrupted() ? kSuccess : kRunFailed;
}

}  // namespace

int run_compare(const CompareOptions& options) {
  model::Scenario scenario = load_changed(options.pack.scenario, options.pack.changes);
  const std::vector<std::string> sequences = choose_sequences(options, scenario);
  const std::vector<std::string> agents = choose(options.agents, packing::agent_names(), "--agents", true);
  const std::vector<SessionPoint> points = list_sessions(options, agents, sequences);
  const std::uint64_t seed = options.pack.seed.value_or(scenario.seed);
  const study::Study study = make_compare_study(options, seed, points);
  const CompareForm form = options.json ? CompareForm::Json : options.csv ? CompareForm::Csv : CompareForm::Table;
  check_words(options.pack, agents);
  NamedFiles inputs = files_of(options.pack.scenario, options.pack.changes, scenario);
  expect_distinct(inputs, options.page ? NamedFiles{{"-o", *options.page}} : NamedFiles{});  // before a folder is made
  std::optional<study::Folder> folder;
  if (options.dir) folder.emplace(study, *options.dir, true);
  if (folder) {
    for (const std::filesystem::path& file : folder->files()) inputs.push_back({"a file of --dir", file});
  }
  std::optional<OutputFile> page = reserve(inputs, options.page);
  if (options.runs) make_folder("--runs", *options.runs);
  catch_interrupts();
  std::fprintf(stderr, "snug: %zu sessions: %zu agents, %zu sequences, %d plants\n", points.size(), agents.size(),
               sequences.size(), options.plants);
  print_now(format_compare_head(form));

  std::vector<CompareSession> sessions;
  Printer printer(form, points.size());
  study::RunSettings settings;
  const int threads = options.pack.threads.value_or(core_count());
  settings.processes = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(threads), points.size()));
  settings.is_stopped = is_interrupted;
  settings.tell = [&](const study::RowResult& result, const std::string& said) {
    if (result.exit_code == kBadInput)
      throw InputError(study.source, "row " + std::to_string(result.row), result.error, "a session that can be run");
    sessions.push_back(read_session(scenario, study, points[result.row], seed, result));
    printer.add(sessions.back().row, said);
    if (options.runs) {
      const std::string recording = recording_of(options, result.row, points[result.row]);
      sessions.back().report = make_report(recording, sessions.back().row);
    }
  };
  const study::Verb pack = [each = threads / settings.processes](const std::vector<std::string>& words) {
    return run_row(words, each);
  };
  const study::RunSummary summary =
      folder ? study::run_study(study, *folder, pack, settings) : study::run_study(study, pack, settings);

  std::vector<CompareRow> rows;
  for (const CompareSession& session : sessions) rows.push_back(session.row);
  if (page) write_file(std::move(*page), format_compare_page(scenario, sessions, *options.page));
  const bool is_own_container = !options.pack.changes.container && !options.pack.changes.pallet;
  print_now(format_compare_end(form, scenario, rows, is_own_container));
  return say_end(rows, points.size(), summary.left_out);
}

}  // namespace snug::app
