// Reach points: where the tool has to be for what packing does, whatever robot is to bring it there.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::runs::internal {

/// What a robot has to reach.
struct ReachTarget {
  const model::Container* container = nullptr;
  double tool_yaw = 0.0;  ///< rad, at its start
};
/// Throws InputError for a scenario without robot, tool, target container, or with a tool that does not point down.
[[nodiscard]] ReachTarget find_target(const model::Scenario& scenario);

/// An item as it stands at the aligner.
struct StandingItem {
  std::string name;
  Vector3 top;   ///< m, in W: middle of the upper face
  Vector3 size;  ///< m, of what it takes up along W
  double height() const { return size.z(); }
};

/// Of all sequences, in their order; none without aligner.
[[nodiscard]] std::vector<StandingItem> find_items(const model::Scenario& scenario);

/// m, of the cup's lip over the container's floor: with a low box on the floor, half way up, at the rim, with a high
/// box carried over the rim.
[[nodiscard]] std::array<double, 4> layer_heights(const model::Container& container,
                                                  const std::vector<StandingItem>& items);

}  // namespace snug::runs::internal
