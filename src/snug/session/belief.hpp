// Belief: what the session takes the cell for: a nominal world and sampled ones, corrected by what is perceived.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/container_state.hpp"
#include "snug/perception/observation.hpp"
#include "snug/plant/plant.hpp"
#include "snug/session/obstacles.hpp"
#include "snug/session/rollout.hpp"

namespace snug::session {

struct BeliefSettings {
  int samples = 8;
  std::uint64_t seed = 1;
  int threads = 1;                     ///< results do not depend on it
  cell::SimulationOptions simulation;  ///< of the nominal world; sampled ones move the tool without joints
};

using CommonDraw = Eigen::Matrix<double, perception::CommonError::ColsAtCompileTime, 1>;

/// Where a box is believed to be.
struct BelievedBox {
  Pose X_WP;  ///< mean
  Matrix6 covariance = Matrix6::Zero();
  bool was_seen = false;  ///< at the last look
};

/// World 0 is nominal: the scenario as it is, with what was measured. The others are drawn from its uncertainty by a
/// seed of the session's own; what is seen replaces what they drew.
class Belief {
 public:
  Belief(const model::Scenario& scenario, const std::string& sequence, const BeliefSettings& settings);

  [[nodiscard]] const model::Sequence& sequence() const { return sequence_; }
  /// The nominal scenario with sizes as measured so far.
  [[nodiscard]] const model::Scenario& nominal() const { return worlds_[0].scenario; }
  [[nodiscard]] int world_count() const { return static_cast<int>(worlds_.size()); }
  /// Of the worlds, the nominal one included (0); of the others the sum is their number.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] const std::optional<BelievedBox>& box(int item) const { return boxes_[static_cast<std::size_t>(item)]; }
  [[nodiscard]] std::vector<perception::Expectation> expectations() const;

  /// What is believed to be in the container beside the items.
  [[nodiscard]] const ObstacleMemory& obstacles() const { return obstacles_; }
  /// A look shows an obstacle that was not known: one picture may be bad, so it takes another look.
  [[nodiscard]] bool has_new_obstacle(const perception::Observation& look) const;
  /// Takes out of `look` the obstacles that were neither known nor seen in the look before.
  void drop_unconfirmed(perception::Observation& look, const perception::Observation& before) const;

  /// The item was brought: it stands where each world has boxes arrive, until it is seen.
  void arrives(int item);
  /// The box is not in the cell any more.
  void forget(int item);
  /// What one look told. Sizes are measured while the item is at the aligner.
  void see(const perception::Observation& observation);
  /// Where rollouts left the boxes, world by world: it is believed of those that are not seen at the next look, and
  /// what is seen then says how well each world predicted.
  void expect(const std::vector<std::vector<std::optional<Pose>>>& predicted);
  /// The same of one box alone, in every world: where it is let go on the way. Nothing is expected of the others.
  void expect_on_the_way(int item, const Pose& X_WP);
  /// The motion that was expected ended early: what is not seen at the next look is believed to be where it was.
  void doubt_prediction() { is_prediction_sound_ = false; }
  /// Boxes are stiffer than was believed, in every world: BeliefParams::stiffer.
  void stiffen();
  /// Weighs the sampled worlds by how near they predicted `item` to where it is believed to be now.
  void weigh(int item);

  /// Rollouts of all worlds, taken up where things are believed to be and the robot says it is.
  [[nodiscard]] const std::vector<std::unique_ptr<Rollout>>& take_up(const plant::Feedback& robot);

 private:
  struct World {
    model::Scenario scenario;
    std::vector<std::optional<Pose>> poses;      ///< X_WP of the items, where this world has them
    std::vector<std::optional<Pose>> predicted;  ///< of the last motion that was sent
    CommonDraw common = CommonDraw::Zero();      ///< standard normals: errors of the sensors
    bool is_stale = true;                        ///< its rollout has to be made anew: a size was measured
  };
  /// The boxes as this look has them, or as they are believed to be.
  [[nodiscard]] std::vector<Solid> solids(const perception::Observation& look) const;
  void see_obstacles(const perception::Observation& look);
  void measure(int item, const perception::PoseEstimate& seen);
  [[nodiscard]] cell::CellAnchor anchor(const World& world, const plant::Feedback& robot) const;

  BeliefSettings settings_;
  std::string sequence_name_;
  model::Sequence sequence_;
  std::vector<World> worlds_;
  std::size_t own_bodies_ = 0;  ///< of the scenario; those of obstacles follow
  std::vector<geometry::Aabb> obstacle_bodies_;
  ObstacleMemory obstacles_;
  double stiffness_ = 1.0;            ///< times what the scenario says
  bool is_prediction_new_ = false;    ///< something was expected since the last look
  bool is_prediction_sound_ = false;  ///< the motion that it is of was not broken off
  std::vector<double> weights_;
  std::vector<std::unique_ptr<Rollout>> rollouts_;
  std::vector<std::optional<BelievedBox>> boxes_;
  Rng rng_;
};

}  // namespace snug::session
