// TestBelief: a belief with rollouts of its worlds, items by their number.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "snug/planning/rollout_pool.hpp"
#include "snug/plant/plant.hpp"
#include "snug/session/belief.hpp"

namespace snug::session::test {

class TestBelief : public Belief {
 public:
  using Belief::Belief;
  int threads = 1;

  [[nodiscard]] const std::optional<planning::BelievedBox>& box(int item) const {
    return Belief::box(model::ItemIndex(item));
  }
  void arrives(int item) { Belief::arrives(model::ItemIndex(item)); }
  void forget(int item) { Belief::forget(model::ItemIndex(item)); }
  void weigh(int item) { Belief::weigh(model::ItemIndex(item)); }
  void expect_on_the_way(int item, const Pose& X_WP) { Belief::expect_on_the_way(model::ItemIndex(item), X_WP); }
  [[nodiscard]] std::vector<double> weights() const {
    std::vector<double> weights;
    for (const planning::World& world : now().worlds) weights.push_back(world.weight);
    return weights;
  }
  [[nodiscard]] std::span<const std::unique_ptr<planning::Rollout>> take_up(const plant::Feedback& robot) {
    edit().robot = {robot.X_WE, robot.q, robot.io};
    return pool_.take_up(now(), threads);
  }

 private:
  planning::RolloutPool pool_;
};

}  // namespace snug::session::test
