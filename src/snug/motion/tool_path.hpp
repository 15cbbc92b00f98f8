// ToolState: pose and velocity of the tool, and the smooth path between two of them one controller tick apart.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::motion {

struct ToolState {
  Pose X_WE;
  Twist V_WE;  ///< linear part at the origin of E; in W
  bool operator==(const ToolState&) const = default;
};

/// Where the tool is at `fraction` (clamped to [0, 1]) of the time `duration` > 0 between two states: cubic Hermite in
/// position and in the rotation vector from the start, so that pose and twist match both ends exactly and the returned
/// twist is the derivative of the returned pose. The turn between the states must be well below pi.
[[nodiscard]] ToolState interpolate(const ToolState& start, const ToolState& end, double duration,
                                    double fraction) noexcept;

}  // namespace snug::motion
