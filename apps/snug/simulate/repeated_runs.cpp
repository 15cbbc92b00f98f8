// Repeated runs: `simulate --monte-carlo N` as a study of `simulate --draw 1 .. N`: one lucky run proves nothing.
#include "apps/snug/simulate/repeated_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
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
  add("--dt", options.physics.dt);
  add("--cup", options.physics.cup);
  add("--record-period", options.physics.record_period);
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

}  // namespace

model::Scenario draw_cell(const model::Scenario& scenario, const std::string& sequence, int draw) {
  const Rng rng = Rng(scenario.seed).split("monte_carlo " + std::to_string(draw - 1));
  return cell::draw_scenario(scenario, sequence, rng);
}

std::vector<study::RepeatedRun> repeat_runs(const SimulateOptions& options, std::uint64_t seed, int count,
                                            int threads) {
  std::vector<study::RepeatedRun> runs;
  study::RunSettings settings;
  settings.processes = std::min(threads, count);
  settings.tell = [&](const study::RowResult& result, const std::string& /*said*/) {
    runs.push_back(study::read_repeated_run(result));
  };
  const study::RunSummary summary = study::run_study(
      make_study(options, seed, count), [](const std::vector<std::string>& words) { return run_row(words); }, settings);
  if (summary.left_out > 0) throw std::runtime_error("processes of the runs were killed");
  return runs;
}

}  // namespace snug::app
