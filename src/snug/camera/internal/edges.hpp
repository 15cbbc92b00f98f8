// Edges of depth and corners of a cast, and how far each pixel is from them.
#pragma once

#include <cstdint>

#include "snug/camera/cast.hpp"

namespace snug::camera::internal {

/// Between a pixel and its neighbour to the right or below.
enum Border : std::uint8_t {
  kJumpRight = 1,  ///< an edge of depth
  kJumpBelow = 2,
  kCornerRight = 4,  ///< two surfaces that meet and look at each other
  kCornerBelow = 8,
};

[[nodiscard]] Grid2<std::uint8_t> find_borders(const Cast& cast, int threads);

/// Pixels to the nearest edge of depth along row or column, 1 beside it; `most` + 1 where there is none so near.
[[nodiscard]] Grid2<std::uint8_t> edge_distance(const Grid2<std::uint8_t>& borders, int most, int threads);
/// Pixels to the nearest corner, counted along rows, then columns, without crossing an edge of depth; `most` + 1 where
/// there is none so near.
[[nodiscard]] Grid2<std::uint8_t> corner_distance(const Grid2<std::uint8_t>& borders, int most, int threads);

}  // namespace snug::camera::internal
