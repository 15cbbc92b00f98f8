// MonteCarlo: the program of a session repeated open loop in cells drawn from the scenario's uncertainty.
#include "snug/study/monte_carlo.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/parallel.hpp"
#include "snug/session/rollout.hpp"

namespace snug::study {
namespace {

constexpr double kRest = 1.0;  ///< s, after the program

struct Run {
  std::vector<cell::BoxResult> boxes;
  double percent = 0.0;
  bool has_failed = false;
};

Run run_once(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program,
             const MonteCarloOptions& options, int index) {
  const Rng rng = Rng(options.seed).split("execution " + std::to_string(index));
  session::Rollout rollout(cell::draw_scenario(cell::with_fixed_arrivals(scenario, sequence), sequence, rng), sequence,
                           options.simulation);
  session::Episode episode = rollout.run(program, {.arm_may_touch = true});
  session::merge(episode, rollout.settle(program, kRest));
  Run run;
  run.has_failed = !episode.is_complete();
  run.boxes = rollout.simulation().boxes(rollout.state());
  std::vector<std::string> packed;
  for (const cell::BoxResult& box : run.boxes) {
    if (box.state == cell::BoxState::Packed) packed.push_back(box.id);
  }
  run.percent =
      model::compute_filling_degree_percent(scenario, *model::find_container(scenario, scenario.target), packed);
  return run;
}

const cell::BoxResult* find_packed(const std::vector<cell::BoxResult>& boxes, const std::string& id) {
  const auto box = std::ranges::find(boxes, id, &cell::BoxResult::id);
  return box != boxes.end() && box->state == cell::BoxState::Packed ? &*box : nullptr;
}

ItemSpread spread_of(const std::string& id, const Pose& X_TP, const std::vector<Run>& runs) {
  ItemSpread spread;
  spread.id = id;
  Vector3 sum = Vector3::Zero(), square = Vector3::Zero();
  for (const Run& run : runs) {
    const cell::BoxResult* box = find_packed(run.boxes, id);
    if (box == nullptr) continue;
    ++spread.succeeded;
    const Vector3 off = box->X_TP.p - X_TP.p;
    sum += off;
    square += off.cwiseProduct(off);
    spread.worst_distance = std::max(spread.worst_distance, off.norm());
  }
  if (spread.succeeded == 0) return spread;
  const Vector3 mean = sum / spread.succeeded;
  spread.deviation = (square / spread.succeeded - mean.cwiseProduct(mean)).cwiseMax(0.0).cwiseSqrt();
  return spread;
}

}  // namespace

MonteCarloResult repeat(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program,
                        const std::vector<packing::Placement>& plan, const MonteCarloOptions& options) {
  MonteCarloResult result;
  result.count = options.count;
  if (program.waypoints.empty() || plan.empty() || options.count <= 0) return result;
  std::vector<Run> runs(static_cast<std::size_t>(options.count));
  parallel_for(options.count, options.threads, [&](int i, int) {
    runs[static_cast<std::size_t>(i)] = run_once(scenario, sequence, program, options, i);
  });
  int good = 0;
  for (const packing::Placement& placement : plan) {
    result.items.push_back(spread_of(placement.item, placement.X_TP, runs));
    good += result.items.back().succeeded;
  }
  result.success_percent =
      100.0 * good / (static_cast<double>(result.items.size()) * static_cast<double>(options.count));
  result.lowest_filling_percent = runs[0].percent;
  for (const Run& run : runs) {
    result.failed += run.has_failed ? 1 : 0;
    result.mean_filling_percent += run.percent / static_cast<double>(options.count);
    result.lowest_filling_percent = std::min(result.lowest_filling_percent, run.percent);
  }
  return result;
}

}  // namespace snug::study
