// Averages: the mean of poses that may be lost, the median of numbers.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "snug/record/archive.hpp"

namespace snug::validation::internal {

/// Mean position and chordal mean of the rotations of those that are tracked; nothing when none is, or less than the
/// share asked for.
[[nodiscard]] std::optional<Pose> mean_pose(std::span<const record::PoseSample> poses, double least_tracked);

/// Standard error of each axis of their mean, from their scatter about it.
struct MeanPoseError {
  double position = 0.0;  ///< m
  double rotation = 0.0;  ///< rad
};
[[nodiscard]] MeanPoseError find_mean_error(std::span<const record::PoseSample> poses, const Pose& mean);

/// The middle one of finite values, the upper of two; 0 of none. Changes their order.
[[nodiscard]] double median(std::vector<double>& values);

}  // namespace snug::validation::internal
