// ToteScene: boxes in the target container as they come to rest there, for judging what sees them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::bench::internal {

struct SceneBox {
  std::string id;
  Vector3 size = Vector3::Zero();  ///< m, collision size: what can be seen
  Pose X_WP;
  bool was_disturbed = false;  ///< moved or tipped by hand after it had come to rest
  Pose X_WP_before;            ///< where it had come to rest first
  bool is_gone = false;        ///< was taken out by hand
};

struct ToteScene {
  std::vector<SceneBox> boxes;
};

enum class Disturbance {
  None,
  Moved,   ///< one box is put elsewhere, turned about the vertical
  Tipped,  ///< one box is let fall in any orientation
  Taken,   ///< one box is taken out
};

/// Boxes of the scenario in an order, with gaps and small turns that the seed draws, planned by the agent `margin`, put
/// down and simulated until they rest. At most `count` boxes.
[[nodiscard]] ToteScene make_tote_scene(const model::Scenario& scenario, std::uint64_t seed, int count,
                                        Disturbance disturbance);

}  // namespace snug::bench::internal
