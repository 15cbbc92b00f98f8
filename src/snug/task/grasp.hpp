// Grasp: a box taken from the aligner and turned so that it hangs from the cup as it shall stand.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "snug/packing/item.hpp"
#include "snug/task/item_plan.hpp"
#include "snug/task/lane.hpp"

namespace snug::task {

/// Executed in all lanes, but not yet taken.
struct Grasp {
  packing::Orientation orientation;  ///< asked for
  /// As it hangs: the same space and the same place of the centre of mass, but perhaps the other end up.
  packing::Orientation held_as;
  TurnManner turn = TurnManner::None;
  std::string problem;  ///< empty, or why it cannot be held so
  motion::Program program;
  Pose X_PS;                            ///< lip on the box
  std::vector<cell::CellState> states;  ///< lane by lane
  std::vector<Episode> episodes;        ///< lane by lane
  double share = 0.0;                   ///< of the samples in which it is held
};

struct GraspRequest {
  const model::Scenario& scenario;
  const CellLayout& layout;
  std::span<const std::unique_ptr<Lane>> lanes;  ///< the first is the one that counts
  std::span<const cell::CellState> states;       ///< lane by lane: from here
  const motion::Program& program;                ///< what was executed so far
  const PlannedBox& box;
  double packed_top = 0.0;  ///< m, z in T of the highest box in the container
  int threads = 1;
  const std::function<bool(const Pose& X_WE)>& reaches;  ///< the tool's poses; empty: all
};
/// The first manner in which the box is held in every lane, or the one that does so in most.
[[nodiscard]] Grasp plan_grasp(const GraspRequest& request, const packing::Orientation& orientation);

}  // namespace snug::task
