// findings_of: what a session has to know of a box that was seen, beside its pose.
#pragma once

#include "snug/box_estimation/estimate.hpp"

namespace snug::box_estimation::internal {

/// How far the sides that were seen are from those that the box should have.
struct SizeMisfit {
  Vector3 misfit = Vector3::Zero();  ///< m, along each axis of P; NaN where not both edges were seen
  double deviations = 0.0;           ///< the largest of them, in standard deviations
};

[[nodiscard]] std::vector<Finding> findings_of(const BoxEstimate& estimate, const ExpectedBox& box,
                                               const EstimateInput& input, const SizeMisfit& size,
                                               const FindingSettings& settings);

}  // namespace snug::box_estimation::internal
