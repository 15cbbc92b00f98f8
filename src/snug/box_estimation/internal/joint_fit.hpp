// fit_boxes: all boxes at once, from planes, edges, beliefs, and that solids do not overlap.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

struct FitResult {
  std::vector<TrackedBox> boxes;
  std::vector<Matrix6> covariance;  ///< in C, [translation; rotation about the box's middle]
  /// m, along each axis of P by how much farther apart opposite edges are than the box is long; NaN where not both were
  /// seen.
  std::vector<Vector3> size_misfit;
  std::vector<bool> is_larger;     ///< a face goes on beyond where its edge was sought
  std::vector<double> size_error;  ///< the largest of them, in standard deviations
};

/// The boxes that are kept, each with what was found of it.
[[nodiscard]] FitResult kept_of(const FitResult& fit, const std::vector<bool>& is_kept);

enum class FitStart {
  Belief,  ///< off by centimetres
  Near,    ///< off by millimetres
};

/// Gauss-Newton steps, each with a new prediction and narrower gates. The first `held` boxes stay where they are and
/// are not measured.
[[nodiscard]] FitResult fit_boxes(const FitContext& context, std::vector<TrackedBox> boxes, FitStart start, int steps,
                                  int held = 0);

}  // namespace snug::box_estimation::internal
