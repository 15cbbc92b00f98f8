// fit_boxes: all boxes at once, from planes, edges, beliefs, and that solids do not overlap.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

struct FitResult {
  std::vector<TrackedBox> boxes;
  std::vector<Matrix6> covariance;         ///< in C, [translation; rotation about the box's middle]
  std::vector<double> size_error;          ///< largest misfit of opposite edges, in standard deviations
  std::vector<double> size_misfit;         ///< m, the same
};

/// Gauss-Newton steps, each with a new prediction and narrower gates. `surroundings_C`: in C.
[[nodiscard]] FitResult fit_boxes(const camera::Frame& frame, const PixelRange& range, const camera::Scene& surroundings_C,
                                  std::vector<TrackedBox> boxes, const ErrorModel& errors, int steps);

}  // namespace snug::box_estimation::internal
