// Obstacles: what is left of a frame when boxes and surroundings are taken away; and how high everything stands.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// Clusters of unexplained points in the region, largest first.
[[nodiscard]] std::vector<Obstacle> find_obstacles(const camera::Frame& frame, const EstimateInput& input,
                                                   const PixelRange& range,
                                                   const camera::Grid2<std::uint8_t>& unexplained_points);
[[nodiscard]] HeightMap make_height_map(const camera::Frame& frame, const EstimateInput& input,
                                        const PixelRange& range);

}  // namespace snug::box_estimation::internal
