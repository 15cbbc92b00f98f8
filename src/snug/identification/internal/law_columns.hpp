// columns_of: what each coefficient of a cup's law contributes to the wrench in a pose.
#pragma once

#include "snug/cup/potential_law.hpp"
#include "snug/identification/cup_poses.hpp"

namespace snug::identification::internal {

/// What the sensor reads for each coefficient at 1, without its zero.
using LawColumns = Eigen::Matrix<double, 6, cup::kLawTerms>;
[[nodiscard]] LawColumns columns_of(const PotentialLaw& law, const Pose& X_BS);

/// Place (m) and rotation (rad), on which the linear fit depends.
[[nodiscard]] Eigen::Matrix<double, 6, 1> linear_columns_of(const Pose& X_BS);

}  // namespace snug::identification::internal
