// Obstacles: what is left of a frame when boxes and surroundings are taken away; and how high everything stands.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// Clusters of unexplained points in the region, largest first. `unexplained_points`: of the context's range.
[[nodiscard]] std::vector<Obstacle> find_obstacles(const FitContext& context, const EstimateInput& input,
                                                   const camera::Grid2<std::uint8_t>& unexplained_points);
[[nodiscard]] HeightMap make_height_map(const FitContext& context, const EstimateInput& input);

}  // namespace snug::box_estimation::internal
