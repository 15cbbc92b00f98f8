// decide_before: agents that re-arrange, or know the sequence, plan all of it before anything is done.
#include "snug/session/internal/decide_before.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/stopwatch.hpp"

namespace snug::session::internal {
namespace {

std::unique_ptr<packing::Agent> make_agent(const Run& run) {
  const planning::BeliefSnapshot& belief = run.belief.now();
  packing::AgentInput input;
  input.settings = belief.scenario.packing;
  input.run = run.options.decision;
  input.run.tries_places = belief.agent.tries_places;
  input.future = belief.agent.future;
  input.sequence = belief.items;
  input.is_reachable = planning::make_reach(belief.scenario, run.cell.layout, run.scene().sequence());
  return packing::make_agent(belief.agent.name, std::move(input));
}

}  // namespace

bool decides_before(const SessionOptions& options) {
  return !options.ask && packing::plans_whole_sequence(options.agent);
}

void decide_before(Run& run) {
  const std::unique_ptr<packing::Agent> agent = make_agent(run);
  planning::BeliefSnapshot& belief = run.belief.edit();
  packing::ContainerState planned = run.scene().container_state();
  for (std::size_t i = 0; i < belief.items.size() && run.agenda.order_ends.empty(); ++i) {
    const packing::Item& item = belief.items[i];
    const auto start = std::chrono::steady_clock::now();
    const auto decision = agent->decide(planned, item);
    event::DecidedBefore decided{model::ItemIndex(i), seconds_since(start), false, {}};
    if (decision) {
      planned = packing::with_candidate(std::move(planned), item, decision->candidates.front());
    } else {
      decided.reason = packing::describe(decision.error());
      decided.is_infeasible = packing::is_infeasible(decision.error());
      if (decided.is_infeasible) ++run.agenda.reported;
      if (!decided.is_infeasible) run.agenda.order_ends = fmt::format("{}: {}", item.id, decided.reason);
    }
    run.log(decided);
  }
  belief.chosen.resize(belief.items.size());
  for (const packing::PlacedBox& box : planned.boxes) {
    const auto item = run.belief.find(box.item.id);
    if (!item) throw InputError("plan", "item", box.item.id, "an item of sequence " + belief.sequence);
    const packing::Orientation orientation = packing::nearest_orientation(box.X_TP.R);
    belief.chosen[item->slot()] =
        packing::Placement{box.item.id, box.X_TP, orientation, packing::count_flips(box.item.arrival, orientation)};
    run.agenda.order.push_back(*item);
  }
}

}  // namespace snug::session::internal
