// row_pose: six cells of a table as a pose.
#pragma once

#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::calibration::internal {

/// Pose from six numbers from `first` on: x, y, z [m], rx, ry, rz (rotation vector, rad).
[[nodiscard]] inline Pose row_pose(const std::vector<double>& row, std::size_t first) {
  return {exp_rotation({row[first + 3], row[first + 4], row[first + 5]}), {row[first], row[first + 1], row[first + 2]}};
}

}  // namespace snug::calibration::internal
