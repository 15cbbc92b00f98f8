// pick_length: how far a cup is pressed when it picks a box.
#pragma once

#include "snug/model/cup_params.hpp"

namespace snug::cup {

/// m, from E to the face when the vacuum comes on: the cup is pressed by 65 % of what it loses under vacuum.
[[nodiscard]] inline double pick_length(const model::CupParams& cup) {
  return cup.hold_length + 0.35 * (cup.free_length - cup.hold_length);
}

}  // namespace snug::cup
