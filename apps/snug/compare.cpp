// compare: agents x sequences x plants.
#include "compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "compare_page.hpp"
#include "compare_report.hpp"
#include "interrupt.hpp"
#include "outputs.hpp"
#include "python_agent.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/packing/representatives.hpp"
#include "snug/study/design.hpp"

namespace snug::app {
namespace {

/// "all" or a list, each checked against what there is.
std::vector<std::string> choose(const std::string& words, const std::vector<std::string>& known, const char* key,
                                bool may_be_python = false) {
  if (words == "all") return known;
  std::vector<std::string> chosen;
  std::stringstream text(words);
  for (std::string word; std::getline(text, word, ',');) {
    if (std::ranges::find(known, word) == known.end() && !(may_be_python && is_python_agent(word))) {
      throw InputError("command line", key, "'" + word + "'", fmt::format("all, or of {}", fmt::join(known, ", ")));
    }
    chosen.push_back(word);
  }
  if (chosen.empty()) throw InputError("command line", key, "nothing", "all, or names separated by commas");
  return chosen;
}

/// Adds sequences of every box of the scenario, in random order; their names.
std::vector<std::string> add_random_sequences(model::Scenario& scenario, int count, std::uint64_t seed) {
  packing::SequenceSettings settings;
  settings.repeat = 0.0;
  settings.all = true;
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) {
    const std::string name = "random-" + std::to_string(i);
    if (model::find_sequence(scenario, name) != nullptr) {
      throw InputError("command line", "--random", "a scenario with a sequence " + name, "one without");
    }
    scenario.sequences.push_back(packing::draw_sequence(scenario, name, settings, Rng(seed).split("sequence " + name)));
    names.push_back(name);
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

/// The words of `snug pack` that do one session again.
std::string words_of(const PackOptions& pack, const study::Trial& trial) {
  using study::quoted;
  const PackOptions usual;
  std::string words =
      fmt::format("snug pack {} --sequence {} --agent {} --seed {} --plant-seed {}", quoted(pack.scenario),
                  quoted(pack.sequence), quoted(pack.agent), trial.seed, pack.plant_seed);
  for (const std::string& file : pack.changes.items) words += " --items " + quoted(file);
  if (pack.changes.container) words += " --container " + quoted(*pack.changes.container);
  if (pack.changes.pallet) words += " --pallet " + quoted(*pack.changes.pallet);
  for (const std::string& change : pack.changes.set) words += " --set " + quoted(change);
  for (const std::string& change : pack.plant_set) words += " --plant-set " + quoted(change);
  if (pack.perception != usual.perception) words += " --perception " + pack.perception;
  if (pack.samples != usual.samples) words += fmt::format(" --samples {}", pack.samples);
  if (pack.skips != usual.skips) words += fmt::format(" --skips {}", pack.skips);
  if (pack.decision_time != usual.decision_time) words += fmt::format(" --decision-time {}", pack.decision_time);
  if (pack.future != usual.future) words += " --future " + pack.future;
  if (!pack.fault.empty()) words += " --fault " + pack.fault;
  if (pack.tempo) words += fmt::format(" --tempo {}", *pack.tempo);
  if (pack.robot) words += " --robot " + quoted(*pack.robot);
  return words;
}

/// The commands that do one session again. A random sequence is drawn first, from the boxes of the scenario's file: no
/// words draw from others.
std::vector<std::string> commands_of(const CompareOptions& options, const PackOptions& pack, const study::Trial& trial,
                                     bool is_random) {
  if (!is_random) return {words_of(pack, trial)};
  if (!pack.changes.items.empty() || !pack.changes.set.empty()) return {};
  return {fmt::format("snug items sequence {} --all --name random --sequences {} --seed {} -o random.yaml",
                      study::quoted(pack.scenario), options.random, options.random_seed),
          words_of(pack, trial) + " --items random.yaml"};
}

}  // namespace

int run_compare(const CompareOptions& options) {
  SourcedScenario loaded = load_with_sources(options.pack.scenario, options.pack.changes);
  model::Scenario& scenario = loaded.scenario;
  const std::vector<std::string> sequences = choose_sequences(options, scenario);
  const std::vector<std::string> agents = choose(options.agents, packing::agent_names(), "--agents", true);
  const std::size_t plants = static_cast<std::size_t>(options.plants);
  const std::size_t runs = agents.size() * sequences.size() * plants;
  const CompareForm form = options.json ? CompareForm::Json : options.csv ? CompareForm::Csv : CompareForm::Table;
  std::optional<OutputFile> page =
      reserve(files_of(options.pack.scenario, options.pack.changes, scenario), options.page);
  catch_interrupts();
  std::vector<CompareRow> rows;
  std::vector<CompareSession> sessions;
  std::fprintf(stderr, "snug: %zu sessions: %zu agents, %zu sequences, %zu plants\n", runs, agents.size(),
               sequences.size(), plants);
  print_now(format_compare_head(form));
  for (std::size_t run = 0; run < runs && !is_interrupted(); ++run) {
    PackOptions pack = options.pack;
    pack.agent = agents[run / (sequences.size() * plants)];
    const std::size_t sequence = run / plants % sequences.size(),
                      given = sequences.size() - static_cast<std::size_t>(options.random);
    pack.plant_seed += run % plants + (sequence > given ? (sequence - given) * plants : 0);
    pack.sequence = sequences[sequence];
    const session::SessionOptions session = make_session_options(pack, loaded, pack.sequence);
    const std::string label =
        fmt::format("{} of {}: {}, sequence {}, plant {}", run + 1, runs, pack.agent, pack.sequence, pack.plant_seed);
    const study::Trial trial = study::run_trial(scenario, pack.sequence, session, make_plant_options(pack, session),
                                                make_progress_line(label));
    rows.push_back(make_row(trial));
    if (page) {
      sessions.push_back(
          {rows.back(), outline_boxes(scenario, trial), commands_of(options, pack, trial, sequence >= given)});
    }
    print_now(format_compare_row(form, rows.back(), run == 0));
  }
  if (page) write_file(std::move(*page), format_compare_page(scenario, sessions));
  const bool is_own_container = !options.pack.changes.container && !options.pack.changes.pallet;
  print_now(format_compare_end(form, scenario, rows, is_own_container));
  const auto failed = std::ranges::count_if(rows, [](const CompareRow& row) { return !row.failure.empty(); });
  if (failed == 0 && !is_interrupted()) return kSuccess;
  if (is_interrupted()) std::fprintf(stderr, "snug: interrupted after %zu of %zu sessions\n", rows.size(), runs);
  if (failed > 0) {
    std::fprintf(stderr, "snug: failed: %d of %zu sessions did not reach their end\n", static_cast<int>(failed),
                 rows.size());
  }
  return kRunFailed;
}

}  // namespace snug::app
