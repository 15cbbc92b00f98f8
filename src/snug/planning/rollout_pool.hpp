// RolloutPool: rollouts of the worlds of a belief, kept from plan to plan.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "snug/planning/belief_snapshot.hpp"
#include "snug/planning/rollout.hpp"

namespace snug::planning {

/// Building a simulated cell takes longer than taking it up: a rollout is built anew only where its world's scenario
/// differs from the one it was built of. What rollouts did before has no influence on what they come to.
class RolloutPool {
 public:
  /// World by world, taken up where things are believed to be and the robot stands. Good until the next call.
  [[nodiscard]] std::span<const std::unique_ptr<Rollout>> take_up(const BeliefSnapshot& belief, int threads);

 private:
  struct Built {
    model::Scenario scenario;
    std::string sequence;
    SimulationChoice options;
    bool operator==(const Built&) const = default;
  };
  std::vector<Built> built_;
  std::vector<std::unique_ptr<Rollout>> rollouts_;
};

}  // namespace snug::planning
