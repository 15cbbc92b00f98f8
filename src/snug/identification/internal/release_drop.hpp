// A release in one dimension: the box under a vertical cup whose gripper moves as it was recorded.
#pragma once

#include <vector>

#include "snug/identification/recorded_releases.hpp"
#include "snug/model/cup_params.hpp"

namespace snug::identification::internal {

struct Drop {
  std::vector<double> height;  ///< m, of the box at the recorded times, from where it hangs
  double length = 0.0;         ///< m, E to lip at the start
  double opening = -1.0;       ///< s; negative: sealed to the end
};

/// Bellows, gas, valve and lip are those of cup/release.hpp, of a cup whose `release` is not used those of
/// cup/phases.hpp; the lip weighs nothing. Smooth in the parameters of `release`: the lip opens within a step.
[[nodiscard]] Drop simulate_drop(const model::CupParams& cup, const RecordedRelease& release);

}  // namespace snug::identification::internal
