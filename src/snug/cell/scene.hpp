// Scene: the bodies of a scenario without robot: free, driven by springs, dropped; stepped one time step at a time.
#pragma once

#include <vector>

#include "snug/cell/lost_body.hpp"
#include "snug/cell/world_builder.hpp"
#include "snug/cup/suction_cup.hpp"

namespace snug::cell {

/// Everything of a scene that changes. A copy is a snapshot.
struct SceneState {
  physics::WorldState world;
  std::size_t dropped = 0;         ///< boxes of the `drops` block that have come
  std::vector<bool> has_appeared;  ///< of Scenario::bodies
  std::vector<LostBody> lost;
};

class Scene {
 public:
  /// At time 0, or where Scenario::initial_state says; throws InputError when that cannot be read.
  /// `threads` share the work of large scenes; the bytes do not depend on their number.
  explicit Scene(const model::Scenario& scenario, int threads = 1);

  /// One step of Scenario::time_step. A body that is lost in it is out of the world from then on.
  physics::StepReport advance();

  [[nodiscard]] const CellWorld& world() const { return world_; }
  /// Bodies that left the cell so far.
  [[nodiscard]] const std::vector<LostBody>& lost() const { return lost_; }
  [[nodiscard]] physics::WorldState& state() { return state_; }
  [[nodiscard]] const physics::WorldState& state() const { return state_; }
  [[nodiscard]] const physics::Workspace& work() const { return work_; }

  [[nodiscard]] SceneState snapshot() const { return {state_, dropped_, has_appeared_, lost_}; }
  /// `state` must be a snapshot of a scene of the same scenario.
  void restore(const SceneState& state);

 private:
  void let_bodies_appear();
  void drop_next();
  /// When a box of the `drops` block appears, s.
  [[nodiscard]] double drop_time(std::size_t index) const;

  model::Scenario scenario_;
  std::vector<physics::BodyId> holders_;  ///< kinematic bodies without shape that carry the springs
  CellWorld world_;
  physics::WorldState state_;
  physics::Workspace work_;
  DropPlan drop_plan_;
  std::size_t dropped_ = 0;
  std::vector<cup::SuctionCup> springs_;
  std::vector<physics::ElementUse> elements_;
  std::vector<physics::KinematicTarget> targets_;
  std::vector<physics::ExternalWrench> wrenches_;
  std::vector<bool> has_appeared_;  ///< of Scenario::bodies
  std::vector<LostBody> lost_;
};

}  // namespace snug::cell
