// PlanningWorkspace: what planning makes of a belief and keeps for the next one: rollouts, the agent, the arm's reach.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "snug/planning/rollout_pool.hpp"
#include "snug/planning/scene.hpp"

namespace snug::planning {

/// What a decision may take. The result depends on `decision_time`, not on `threads`.
struct Budget {
  double decision_time = packing::DecisionRun{}.time;  ///< s an item: packing::DecisionRun::time
  int threads = 1;
  bool operator==(const Budget&) const = default;
};

/// One per thread that plans. It has no influence on what is decided, unless who is asked has a memory.
class PlanningWorkspace {
 public:
  /// `ask`: who decides where AgentSettings::is_asked.
  explicit PlanningWorkspace(packing::Ask ask = {}) : ask_(std::move(ask)) {}

  [[nodiscard]] const CellPlan& cell_of(const BeliefSnapshot& belief);
  /// Who decides where this item goes: the agent, or its place that was chosen before. Throws InputError for an agent
  /// that is not known, or is asked where nobody is.
  [[nodiscard]] packing::Agent& agent_for(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget);
  [[nodiscard]] RolloutPool& rollouts() { return rollouts_; }

 private:
  struct Made {
    model::Scenario scenario;
    std::string sequence;
    motion::Tracking tracking;
    std::vector<std::optional<packing::Placement>> chosen;
    bool operator==(const Made&) const = default;
  };
  struct MadeAgent {
    AgentSettings settings;
    Budget budget;
    bool operator==(const MadeAgent&) const = default;
  };
  void take_over(const BeliefSnapshot& belief);

  packing::Ask ask_;
  std::optional<Made> made_;
  std::optional<CellPlan> cell_;
  std::optional<MadeAgent> made_agent_;
  std::unique_ptr<packing::Agent> agent_;
  std::vector<std::unique_ptr<packing::Agent>> chosen_;  ///< item by item, of places chosen before
  RolloutPool rollouts_;
};

}  // namespace snug::planning
