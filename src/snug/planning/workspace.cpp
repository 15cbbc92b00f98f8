// PlanningWorkspace: what planning makes of a belief and keeps for the next one: rollouts, the agent, the arm's reach.
#include "snug/planning/workspace.hpp"

#include <utility>

#include "snug/core/input_error.hpp"

namespace snug::planning {
namespace {

/// Of one item, whose place was chosen before the session began.
class ChosenPlace final : public packing::Agent {
 public:
  explicit ChosenPlace(const std::optional<packing::Placement>& placement) : placement_(placement) {}
  [[nodiscard]] std::string_view name() const override { return "chosen place"; }
  [[nodiscard]] Expected<packing::Decision, packing::NoPlace> decide(const packing::ContainerState& /*state*/,
                                                                     const packing::Item& /*item*/) override {
    if (!placement_) return tl::unexpected(packing::NoPlace::NoSpace);
    packing::Decision decision;
    decision.candidates.emplace_back().placement = *placement_;
    return decision;
  }

 private:
  std::optional<packing::Placement> placement_;
};

}  // namespace

void PlanningWorkspace::take_over(const BeliefSnapshot& belief) {
  Made wanted{belief.scenario, belief.sequence, belief.simulation.tracking, belief.chosen};
  if (made_ == wanted) return;
  made_ = std::move(wanted);
  cell_ = make_cell_plan(belief.scenario, belief.simulation.tracking);
  made_agent_.reset();
  chosen_.clear();
  for (const auto& placement : belief.chosen) chosen_.push_back(std::make_unique<ChosenPlace>(placement));
}

const CellPlan& PlanningWorkspace::cell_of(const BeliefSnapshot& belief) {
  take_over(belief);
  return *cell_;
}

packing::Agent& PlanningWorkspace::agent_for(const BeliefSnapshot& belief, model::ItemIndex item,
                                             const Budget& budget) {
  take_over(belief);
  if (!chosen_.empty()) return *chosen_[item.slot()];
  const MadeAgent wanted{belief.agent, budget};
  if (made_agent_ == wanted) return *agent_;
  if (belief.agent.is_asked && !ask_) {
    throw InputError("agent", belief.agent.name, "nobody to ask", "an agent that decides here");
  }
  packing::AgentInput input;
  input.settings = belief.scenario.packing;
  input.run = {budget.decision_time, belief.agent.seed, budget.threads, belief.agent.tries_places};
  input.future = belief.agent.future;
  if (belief.agent.is_asked) input.ask = ask_;
  input.is_reachable = make_reach(belief.scenario, cell_->layout, Scene{belief, *cell_}.sequence());
  agent_ = packing::make_agent(belief.agent.name, std::move(input));
  made_agent_ = wanted;
  return *agent_;
}

}  // namespace snug::planning
