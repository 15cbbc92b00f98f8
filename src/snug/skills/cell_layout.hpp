// CellLayout: what the plans of all items of a cell have in common.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"
#include "snug/motion/way.hpp"

namespace snug::skills {

/// The flat surface on which boxes are flipped.
struct FlipPlace {
  Vector3 p_WF = Vector3::Zero();        ///< m, under the middle of the box
  Vector3 direction = Vector3::UnitX();  ///< unit, where the tool points when it lets go
};

/// What the plans of all items have in common.
struct CellLayout {
  Pose X_WT;                                ///< target container
  double rim = 0.0;                         ///< m, z in T of the upper edges of its walls; 0 without walls
  double fixed_top = 0.0;                   ///< m, z in W of the highest fixed thing that the tool passes
  std::optional<FlipPlace> flip_place;      ///< absent: nothing flat is large enough
  std::optional<motion::PanAxis> pan_axis;  ///< of the robot, where that is vertical
  double neutral_yaw = 0.0;                 ///< rad, of the tool at its start: half a turn to either side of it is used
  /// Motions are fast ones (motion::FastTracking{}): tracked exactly, around the robot's first axis. A held box
  /// turns the way round that leaves the wrist less to do, and while it travels.
  bool is_fast = false;
  settings::TravelParams travel;
  double cup_growth = 0.0;  ///< m, of a cup that lets go
};
/// Throws InputError for a scenario without aligner, tool or target container.
[[nodiscard]] CellLayout make_layout(const model::Scenario& scenario, const std::optional<motion::PanAxis>& pan_axis);

/// m, over what is crossed.
[[nodiscard]] double crossing_clearance(const CellLayout& layout);
/// z in W below which nothing passes that crosses the cell: over fixed things, rim and packed boxes.
[[nodiscard]] double travel_bottom(const CellLayout& layout, double packed_top);

}  // namespace snug::skills
