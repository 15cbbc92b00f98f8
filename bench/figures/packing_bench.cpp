// measure_packing: how long deciding takes and what it plans; what loading makes of public instances.
#include "bench/figures/internal/packing_bench.hpp"

#include <algorithm>

#include "bench/figures/internal/cpu_time.hpp"
#include "snug/packing/agent.hpp"
#include "snug/packing/instances.hpp"

namespace snug::bench::internal {
namespace {

/// Percent of the container that is filled when an item has no place, or all have one.
double plan_sequence(const model::Scenario& scenario, const model::Sequence& sequence, std::vector<double>& seconds) {
  packing::AgentInput input;
  input.settings = scenario.packing;
  input.run.seed = scenario.seed;
  input.future = packing::make_future_model(scenario);
  const std::unique_ptr<packing::Agent> agent = packing::make_agent("contact-aware", std::move(input));
  packing::ContainerState state = packing::make_container_state(*model::find_container(scenario, scenario.target));
  for (const packing::Item& item : packing::make_items(scenario, sequence)) {
    const double start = cpu_seconds();
    const auto decision = agent->decide(state, item);
    seconds.push_back(cpu_seconds() - start);
    if (!decision) break;
    state = packing::with_candidate(std::move(state), item, decision->candidates.front());
  }
  return packing::filling_percent(state);
}

}  // namespace

DecisionFigures measure_decisions(const model::Scenario& scenario) {
  DecisionFigures figures;
  std::vector<double> seconds;
  for (const model::Sequence& sequence : scenario.sequences) {
    figures.planned_percent +=
        plan_sequence(scenario, sequence, seconds) / static_cast<double>(scenario.sequences.size());
  }
  if (seconds.empty()) return figures;
  std::ranges::sort(seconds);
  figures.median_seconds = seconds[seconds.size() / 2];
  figures.longest_seconds = seconds.back();
  return figures;
}

std::vector<LoadFigure> measure_loads(const std::filesystem::path& folder, double seconds) {
  std::vector<LoadFigure> figures;
  for (int set = 1; set <= 7; ++set) {
    const std::string name = "BR" + std::to_string(set);
    const std::filesystem::path file = folder / (name + ".txt");
    if (!std::filesystem::exists(file)) continue;
    const std::vector<packing::LoadProblem> problems = packing::load_instances(file);
    if (problems.empty()) continue;
    figures.push_back({name, packing::load_container(problems.front(), {seconds, 1}).percent});
  }
  return figures;
}

}  // namespace snug::bench::internal
