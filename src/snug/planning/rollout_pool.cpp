// RolloutPool: rollouts of the worlds of a belief, kept from plan to plan.
#include "snug/planning/rollout_pool.hpp"

#include <utility>

#include "snug/core/parallel.hpp"

namespace snug::planning {
namespace {

cell::CellAnchor anchor_of(const BeliefSnapshot& belief, const World& world) {
  cell::CellAnchor anchor;
  anchor.X_WE = belief.robot.X_WE;
  anchor.q = belief.robot.q;
  for (std::size_t i = 0; i < belief.boxes.size(); ++i) {
    if (belief.boxes[i] && world.X_WP[i]) anchor.boxes.push_back({static_cast<int>(i), *world.X_WP[i]});
  }
  return anchor;
}

}  // namespace

std::span<const std::unique_ptr<Rollout>> RolloutPool::take_up(const BeliefSnapshot& belief, int threads) {
  rollouts_.resize(belief.worlds.size());
  built_.resize(belief.worlds.size());
  parallel_for(static_cast<int>(belief.worlds.size()), threads, [&](int index, int) {
    const auto w = static_cast<std::size_t>(index);
    const World& world = belief.worlds[w];
    Built wanted{world.scenario, belief.sequence, belief.simulation};
    if (w > 0) wanted.options.robot.clear();
    if (!rollouts_[w] || built_[w] != wanted) {
      rollouts_[w] = std::make_unique<Rollout>(wanted.scenario, wanted.sequence, wanted.options);
      built_[w] = std::move(wanted);
    }
    rollouts_[w]->take_up(anchor_of(belief, world), belief.nominal().belief.rest);
  });
  return rollouts_;
}

}  // namespace snug::planning
