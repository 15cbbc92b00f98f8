// Belief: what the session takes the cell for: a nominal world and sampled ones, corrected by what is perceived.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/perception/observation.hpp"
#include "snug/planning/belief_snapshot.hpp"
#include "snug/session/obstacles.hpp"

namespace snug::session {

struct BeliefSettings {
  int samples = 8;
  std::uint64_t seed = 1;
  cell::SimulationOptions simulation = {};  ///< of the nominal world; sampled ones move the tool without joints
};

using CommonDraw = Eigen::Matrix<double, perception::CommonError::ColsAtCompileTime, 1>;

/// World 0 is nominal: the scenario as it is, with what was measured. The others are drawn from its uncertainty by a
/// seed of the session's own; what is seen replaces what they drew.
class Belief {
 public:
  /// Throws InputError for an unknown sequence.
  Belief(const model::Scenario& scenario, const std::string& sequence, const BeliefSettings& settings);

  /// Everything that a decision depends on, now.
  [[nodiscard]] const planning::BeliefSnapshot& now() const { return now_; }
  /// What the session itself did and wants: sent, skipped, next, robot, agent, chosen places, how items stood last.
  [[nodiscard]] planning::BeliefSnapshot& edit() { return now_; }

  /// The nominal scenario with sizes as measured so far.
  [[nodiscard]] const model::Scenario& nominal() const { return now_.nominal(); }
  [[nodiscard]] const std::optional<planning::BelievedBox>& box(model::ItemIndex item) const {
    return now_.boxes[item.slot()];
  }
  /// None where the sequence has no item of this name.
  [[nodiscard]] std::optional<model::ItemIndex> find(const std::string& id) const;
  [[nodiscard]] std::vector<perception::Expectation> expectations() const;

  /// What is believed to be in the container beside the items.
  [[nodiscard]] const ObstacleMemory& obstacles() const { return obstacles_; }
  /// An observation shows an obstacle that was not known: one picture may be bad, so it takes another.
  [[nodiscard]] bool has_new_obstacle(const perception::Observation& seen) const;
  /// Takes out of `seen` the obstacles that were neither known nor seen in the observation before.
  void drop_unconfirmed(perception::Observation& seen, const perception::Observation& before) const;

  /// The item was brought: it stands where each world has boxes arrive, until it is seen.
  void arrives(model::ItemIndex item);
  /// The box is not in the cell any more.
  void forget(model::ItemIndex item);
  /// What one observation told. Sizes are measured while the item is at the aligner.
  void see(const perception::Observation& observation);
  /// Where rollouts left the boxes, world by world: it is believed of those that are not seen by the next observation,
  /// and what is seen then says how well each world predicted.
  void expect(const std::vector<std::vector<std::optional<Pose>>>& predicted);
  /// The same of one box alone, in every world: where it is let go on the way. Nothing is expected of the others.
  void expect_on_the_way(model::ItemIndex item, const Pose& X_WP);
  /// The motion that was expected ended early: what the next observation does not see is believed to be where it was.
  void doubt_prediction() { is_prediction_sound_ = false; }
  /// It fell, or is let go, before its motion ended: where the next observation does not see it, it could be anywhere.
  void let_go(model::ItemIndex item) { released_ = item; }
  /// After an observation.
  void forget_let_go();
  /// Boxes are stiffer than was believed, in every world: BeliefParams::stiffer.
  void stiffen();
  /// Weighs the sampled worlds by how near they predicted `item` to where it is believed to be now.
  void weigh(model::ItemIndex item);

 private:
  /// What a world is to the filter alone.
  struct Filter {
    std::vector<std::optional<Pose>> predicted;  ///< of the last motion that was sent
    CommonDraw common = CommonDraw::Zero();      ///< standard normals: errors of the sensors
  };
  /// The boxes as this observation has them, or as they are believed to be.
  [[nodiscard]] std::vector<Solid> solids(const perception::Observation& seen) const;
  void see_obstacles(const perception::Observation& seen);
  void measure(model::ItemIndex item, const perception::PoseEstimate& seen);

  planning::BeliefSnapshot now_;
  std::vector<Filter> filters_;  ///< world by world
  ObstacleMemory obstacles_;
  bool is_prediction_new_ = false;    ///< something was expected since the last observation
  bool is_prediction_sound_ = false;  ///< the motion that it is of was not broken off
  model::ItemIndex released_;
  Rng rng_;
};

}  // namespace snug::session
