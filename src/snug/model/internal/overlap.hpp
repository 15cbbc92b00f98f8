// overlap_of: how deep two placed shapes are in each other.
#pragma once

#include "snug/model/body.hpp"

namespace snug::model::internal {

/// Depth of overlap of two shapes, m; 0 when they are apart.
[[nodiscard]] double overlap_of(const PlacedShape& a, const Pose& X_WA, const PlacedShape& b, const Pose& X_WB);

}  // namespace snug::model::internal
