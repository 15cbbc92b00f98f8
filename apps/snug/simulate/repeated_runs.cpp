// Repeated runs: `simulate --monte-carlo N` as a study of `simulate --draw 1 .. N`: one lucky run proves nothing.
#include "apps/snug/simulate/repeated_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/study/row_values.hpp"
#include "snug/study/run.hpp"

namespace snug::app {
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
  add("--dt", options.dt);
  add("--cup", options.cup);
  add("--record-period", options.record_period);
  words.emplace_back("--seed", std::to_string(seed));
  std::vector<std::string> flat;
  for (const auto& [option, value] : words) flat.insert(flat.end(), {option, value});
  return flat;
}

study::Study make_study(const SimulateOptions& options, std::uint64_t seed, int count) {
  study::Study study;
  study.name = study.source = "--monte-carlo";
  study.verb = "simulate";
  study.scenario = find_scenario(options.scenario);
  study.options = common_words(options, seed);
  study.seed_option.clear();
  study.factors = {{.name = "draw", .option = "--draw", .key = {}, .values = {}}};
  for (int draw = 1; draw <= count; ++draw) study.factors[0].values.push_back(std::to_string(draw));
  study.point_count = static_cast<std::uint64_t>(count);
  study.outputs = {{"filling_degree_percent"}, {"boxes"}, {"repick_offset_worst_mm"}, {"state_hash"}, {"failure"}};
  study.chunk = count;
  return study;
}

RepeatedRun read_run(const study::RowResult& result) {
  const study::RowValues values(result);
  RepeatedRun run;
  for (const auto& box : values.list("boxes")) {
    ++run.boxes;
    run.packed += box.at("state") == "packed" ? 1 : 0;
  }
  run.filling_degree_percent = values.number("filling_degree_percent");
  run.worst_repick_mm = values.number("repick_offset_worst_mm");
  run.state_hash = values.word("state_hash");
  run.failure = run.state_hash.empty() ? result.error : values.word("failure");
  return run;
}

/// Of the share of boxes that are packed, percent.
struct Spread {
  double mean = 0.0, deviation = 0.0, lowest = 100.0;
  int failed = 0;
};

Spread find_spread(const std::vector<RepeatedRun>& runs) {
  Spread spread;
  double sum = 0.0, square = 0.0;
  for (const RepeatedRun& run : runs) {
    const double percent = run.boxes > 0 ? 100.0 * run.packed / run.boxes : 0.0;
    spread.failed += run.failure.empty() ? 0 : 1;
    sum += percent;
    square += percent * percent;
    spread.lowest = std::min(spread.lowest, percent);
  }
  const double count = static_cast<double>(runs.size());
  spread.mean = sum / count;
  spread.deviation = std::sqrt(std::max(0.0, square / count - spread.mean * spread.mean));
  return spread;
}

}  // namespace

model::Scenario draw_cell(const model::Scenario& scenario, const std::string& sequence, int draw) {
  const Rng rng = Rng(scenario.seed).split("monte_carlo " + std::to_string(draw - 1));
  return cell::draw_scenario(scenario, sequence, rng);
}

std::vector<RepeatedRun> repeat_runs(const SimulateOptions& options, std::uint64_t seed, int count, int threads) {
  std::vector<RepeatedRun> runs;
  study::RunSettings settings;
  settings.processes = std::min(threads, count);
  settings.tell = [&](const study::RowResult& result, const std::string& /*said*/) {
    runs.push_back(read_run(result));
  };
  const study::RunSummary summary = study::run_study(
      make_study(options, seed, count), [](const std::vector<std::string>& words) { return run_row(words); }, settings);
  if (summary.left_out > 0) throw std::runtime_error("processes of the runs were killed");
  return runs;
}

std::string format_table(const std::vector<RepeatedRun>& runs) {
  std::string text = fmt::format("{:>4} {:>7} {:>10} {:>10}  {:<16} {}\n", "run", "packed", "filling %", "re-pick mm",
                                 "state hash", "failure");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RepeatedRun& run = runs[i];
    text += fmt::format("{:>4} {:>4}/{:<2} {:>10.2f} {:>10.1f}  {} {}\n", i + 1, run.packed, run.boxes,
                        run.filling_degree_percent, run.worst_repick_mm, run.state_hash, run.failure);
  }
  const Spread spread = find_spread(runs);
  return text + fmt::format("\npacked             mean {:.1f} %, standard deviation {:.1f} %, lowest {:.1f} %\n",
                            spread.mean, spread.deviation, spread.lowest);
}

std::string format_json(const std::vector<RepeatedRun>& runs) {
  const Spread spread = find_spread(runs);
  nlohmann::ordered_json document = {{"mean_packed_percent", spread.mean},
                                     {"standard_deviation_percent", spread.deviation},
                                     {"lowest_packed_percent", spread.lowest},
                                     {"failed_runs", spread.failed},
                                     {"runs", nlohmann::ordered_json::array()}};
  for (const RepeatedRun& run : runs) {
    document["runs"].push_back({{"packed", run.packed},
                                {"boxes", run.boxes},
                                {"filling_degree_percent", run.filling_degree_percent},
                                {"repick_offset_worst_mm", run.worst_repick_mm},
                                {"state_hash", run.state_hash},
                                {"failure", run.failure}});
  }
  return document.dump(2) + "\n";
}

}  // namespace snug::app
