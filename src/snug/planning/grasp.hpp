// Grasp: a box taken from where it stands and turned so that it hangs from the cup as it shall stand.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/packing/item.hpp"
#include "snug/planning/reach.hpp"
#include "snug/planning/rollout.hpp"
#include "snug/planning/scene.hpp"
#include "snug/skills/item_plan.hpp"

namespace snug::planning {

/// Why a box cannot be held as asked.
enum class GraspProblem {
  None,
  NotHeld,       ///< the cup did not hold it, or lost it
  SideTooLow,    ///< the side is too low for the cup
  OutOfReach,    ///< of the robot
  DoesNotStand,  ///< where it was put down
  NoSurface,     ///< nothing flat to turn it on, or every way of turning it was refused
  Rollout,       ///< the nominal rollout ended early: see its episode
  TooHeavy,      ///< of a box that is heavy for the cup, in too many worlds: it would hold too little when lifted
};
[[nodiscard]] const char* describe(GraspProblem problem);

/// Rehearsed in all rollouts, but not yet sent.
struct Grasp {
  packing::Orientation orientation;  ///< asked for
  /// As it hangs: the same space, but perhaps the other end up (the place of the centre of mass then the same), or
  /// turned by half a turn (skills::CellLayout::is_fast).
  packing::Orientation held_as;
  skills::Reorientation reorientation = skills::Reorientation::None;
  GraspProblem problem = GraspProblem::None;
  motion::Program program;
  /// So many waypoints are done when the box is let go on the way: it is perceived there.
  std::vector<std::size_t> stages;
  std::vector<Pose> stage_poses;       ///< X_WP at each of them in the nominal rollout
  Pose X_PS;                           ///< lip on the box
  std::optional<motion::Swing> swing;  ///< of how it hangs
  Pose X_EP;                           ///< as the box hangs from the tool in the end, nominal
  std::vector<motion::Program>
      programs;  ///< rollout by rollout: where the box is let go elsewhere on the way, other waypoints
  std::vector<cell::CellState> states;  ///< rollout by rollout
  std::vector<Episode> episodes;        ///< rollout by rollout
  double success_rate = 0.0;            ///< fraction of the samples, by weight, in which it is held
};

struct GraspRequest {
  const model::Scenario& scenario;  ///< nominal
  const skills::CellLayout& layout;
  std::span<const std::unique_ptr<Rollout>> rollouts;  ///< the first is the nominal one; none: see outline_grasp
  std::span<const cell::CellState> states;             ///< rollout by rollout: from here
  std::span<const double> weights;                     ///< rollout by rollout; the first is not used
  motion::Waypoint from;                               ///< where the tool is
  const skills::PlannedBox& box;
  Pose X_WP;  ///< where it is believed to stand
  Location location = Location::Aligner;
  double packed_top = 0.0;  ///< m, z in T of the highest box in the container
  int threads = 1;
  const ToolReach& reaches;
  std::vector<skills::Reorientation> refused = {};  ///< not to be tried
};
/// The first reorientation with which the box is held in every rollout, or the one that does so in most.
[[nodiscard]] Grasp plan_grasp(const GraspRequest& request, const packing::Orientation& orientation);

/// How a grasp begins, nothing rehearsed.
struct GraspOutline {
  skills::Reorientation reorientation = skills::Reorientation::None;
  Pose X_WE;  ///< where the tool comes to before it goes down to the box
};
/// Of the way that is tried first; none: it cannot be picked so. Without rollouts, states and weights in the request.
[[nodiscard]] std::optional<GraspOutline> outline_grasp(const GraspRequest& request,
                                                        const packing::Orientation& orientation);

}  // namespace snug::planning
