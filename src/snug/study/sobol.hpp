// Sobol points: numbers that fill a cube evenly, each found from its index alone.
#pragma once

#include <cstdint>

namespace snug::study {

inline constexpr int kMostSobolDimensions = 21;

/// Coordinate `dimension` (from 0) of point `index` (below 2^32) of Sobol's sequence, in [0, 1), with the direction
/// numbers of Joe and Kuo (2008, new-joe-kuo-6) and without their Gray code: any index costs the same. `shift` (a
/// digital shift, random or 0) moves all points of a dimension without making them less even.
[[nodiscard]] double sobol(std::uint32_t index, int dimension, std::uint32_t shift = 0);

}  // namespace snug::study
