// findings_of: what a session has to know of a box that was seen, beside its pose.
#pragma once

#include "snug/box_estimation/estimate.hpp"

namespace snug::box_estimation::internal {

/// `size_misfit`, `size_error`: as FitResult has them for this box.
[[nodiscard]] std::vector<Finding> findings_of(const BoxEstimate& estimate, const ExpectedBox& box,
                                               const EstimateInput& input, const Vector3& size_misfit,
                                               double size_error);

}  // namespace snug::box_estimation::internal
