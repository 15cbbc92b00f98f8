// MonteCarlo: the program of a session repeated open loop in cells drawn from the scenario's uncertainty.
#include "snug/study/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/planning/rollout.hpp"
#include "snug/study/run.hpp"

namespace snug::study {
namespace {

constexpr double kRest = 1.0;  ///< s, after the program

struct Run {
  std::vector<std::pair<std::string, Vector3>> packed;  ///< id, middle in T, m
  double percent = 0.0;
  bool has_failed = false;
};

Run run_once(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program,
             const MonteCarloOptions& options, int index) {
  const Rng rng = Rng(options.seed).split("execution " + std::to_string(index));
  planning::Rollout rollout(cell::draw_scenario(cell::with_fixed_arrivals(scenario, sequence), sequence, rng), sequence,
                            options.simulation);
  planning::Episode episode = rollout.run(program, {.arm_may_touch = true});
  planning::merge(episode, rollout.settle(program, kRest));
  Run run;
  run.has_failed = !episode.is_complete();
  std::vector<std::string> packed;
  for (const cell::BoxResult& box : rollout.simulation().boxes(rollout.state())) {
    if (box.state != cell::BoxState::Packed) continue;
    packed.push_back(box.id);
    run.packed.emplace_back(box.id, box.X_TP.p);
  }
  run.percent =
      model::compute_filling_degree_percent(scenario, *model::find_container(scenario, scenario.target), packed);
  return run;
}

// A run is a row in a process of its own, which says it in these words.
using Json = nlohmann::ordered_json;

std::string format_run(const Run& run) {
  Json packed = Json::array();
  for (const auto& [id, p] : run.packed) packed.push_back({id, p.x(), p.y(), p.z()});
  return Json{{"packed", packed}, {"percent", run.percent}, {"has_failed", run.has_failed}}.dump();
}

Run read_run(const RowResult& result) {
  if (result.exit_code != 0) throw std::runtime_error("a repeated run: " + result.error);
  Run run;
  run.percent = std::get<double>(result.values.at(1).second);
  run.has_failed = std::get<double>(result.values.at(2).second) != 0.0;
  for (const Json& box : Json::parse(std::get<std::string>(result.values.at(0).second))) {
    run.packed.emplace_back(box.at(0).get<std::string>(),
                            Vector3(box.at(1).get<double>(), box.at(2).get<double>(), box.at(3).get<double>()));
  }
  return run;
}

Study make_study(int count) {
  Study study;
  study.name = study.source = study.verb = "execution";
  study.seed_option.clear();
  study.factors = {{.name = "execution", .option = "--execution", .key = {}, .values = {}}};
  for (int i = 0; i < count; ++i) study.factors[0].values.push_back(std::to_string(i));
  study.point_count = static_cast<std::uint64_t>(count);
  study.outputs = {{"packed"}, {"percent"}, {"has_failed"}};
  study.chunk = count;
  return study;
}

ItemSpread spread_of(const std::string& id, const Pose& X_TP, const std::vector<Run>& runs) {
  ItemSpread spread;
  spread.id = id;
  Vector3 sum = Vector3::Zero(), square = Vector3::Zero();
  for (const Run& run : runs) {
    const auto box = std::ranges::find(run.packed, id, &std::pair<std::string, Vector3>::first);
    if (box == run.packed.end()) continue;
    ++spread.succeeded;
    const Vector3 off = box->second - X_TP.p;
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
  std::vector<Run> runs;
  RunSettings settings;
  settings.processes = options.threads;
  settings.tell = [&](const RowResult& one, const std::string& /*said*/) { runs.push_back(read_run(one)); };
  const Verb execute = [&](const std::vector<std::string>& words) {  // execution --execution INDEX --json
    std::fputs(format_run(run_once(scenario, sequence, program, options, std::stoi(words.at(2)))).c_str(), stdout);
    return 0;
  };
  if (run_study(make_study(options.count), execute, settings).left_out > 0)
    throw std::runtime_error("processes of repeated runs were killed");
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
