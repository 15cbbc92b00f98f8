// MonteCarlo: the same run in cells drawn from the scenario's uncertainty: one lucky run proves nothing.
#include "snug/cell/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/rng.hpp"

namespace snug::cell {
namespace {

MonteCarloRun run_one(const model::Scenario& scenario, const RunOptions& options, const MonteCarloOptions& monte_carlo,
                      int index) {
  const Rng rng = Rng(monte_carlo.seed).split("monte_carlo " + std::to_string(index));
  const RunResult result = run(draw_scenario(scenario, options.sequence, rng), options);
  MonteCarloRun one;
  one.boxes = static_cast<int>(result.boxes.size());
  one.packed = static_cast<int>(std::count_if(result.boxes.begin(), result.boxes.end(),
                                              [](const BoxResult& box) { return box.state == BoxState::Packed; }));
  one.filling_degree_percent = result.filling_degree_percent;
  for (const Repick& repick : result.repicks) one.worst_repick = std::max(one.worst_repick, repick.offset);
  one.state_hash = result.state_hash;
  one.failure = result.failure;
  return one;
}

void summarize(MonteCarloResult& result) {
  double sum = 0.0, square = 0.0;
  result.lowest_packed_percent = 100.0;
  for (const MonteCarloRun& one : result.runs) {
    const double percent = one.boxes > 0 ? 100.0 * one.packed / one.boxes : 0.0;
    result.failed_runs += one.failure.empty() ? 0 : 1;
    sum += percent;
    square += percent * percent;
    result.lowest_packed_percent = std::min(result.lowest_packed_percent, percent);
  }
  const double count = static_cast<double>(result.runs.size());
  result.mean_packed_percent = sum / count;
  const double variance = square / count - result.mean_packed_percent * result.mean_packed_percent;
  result.standard_deviation_percent = std::sqrt(std::max(0.0, variance));
}

}  // namespace

MonteCarloResult run_monte_carlo(const model::Scenario& scenario, const RunOptions& options,
                                 const MonteCarloOptions& monte_carlo) {
  RunOptions unrecorded = options;
  unrecorded.record_path.clear();
  unrecorded.record_file = nullptr;
  unrecorded.observer = nullptr;
  unrecorded.threads = 1;  // runs share them out
  MonteCarloResult result;
  result.runs.resize(static_cast<std::size_t>(monte_carlo.count));
  parallel_for(monte_carlo.count, monte_carlo.threads, [&](int i, int) {
    result.runs[static_cast<std::size_t>(i)] = run_one(scenario, unrecorded, monte_carlo, i);
  });
  summarize(result);
  return result;
}

}  // namespace snug::cell
