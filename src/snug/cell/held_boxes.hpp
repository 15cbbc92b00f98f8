// HeldBoxes: which box hangs in the cup while a program runs, and how, as far as the names of its rows tell.
#pragma once

#include <optional>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::cell {

struct HeldBox {
  int item = -1;                   ///< of the sequence
  Vector3 size = Vector3::Zero();  ///< m, collision size
  Pose X_EP;                       ///< held stiffly, its face where the lip is under vacuum
};

struct StandingBox {
  int item = -1;
  Vector3 size = Vector3::Zero();  ///< m
  Pose X_WP;                       ///< where it was let go, set upright
};

/// Follows a program row by row. A box is picked where it stands at the aligner; one that is picked up again stands on
/// the face nearest to the one it was let go on. Where a name tells of no box of the sequence, none is held.
class HeldBoxes {
 public:
  HeldBoxes(const model::Scenario& scenario, const model::Sequence& sequence)
      : scenario_(&scenario), sequence_(&sequence) {}

  /// The switches of `row` act, with the tool at X_WE. To be called for every row in order.
  void depart(const motion::Program& program, int row, const Pose& X_WE);
  [[nodiscard]] const std::optional<HeldBox>& held() const { return held_; }
  /// Let go, and not picked again.
  [[nodiscard]] const std::vector<StandingBox>& standing() const { return standing_; }
  /// The vacuum is on, but no name tells what it holds.
  [[nodiscard]] bool is_unknown() const { return vacuum_ && !held_; }

 private:
  const model::Scenario* scenario_;
  const model::Sequence* sequence_;
  bool vacuum_ = false;
  std::optional<HeldBox> held_;
  std::optional<HeldBox> released_;
  Pose X_WP_released_;
  std::vector<StandingBox> standing_;
};

}  // namespace snug::cell
