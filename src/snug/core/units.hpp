// Units of tables and plots beside those of the program (SI), and the number that is none.
#pragma once

#include <limits>
#include <numbers>

namespace snug {

inline constexpr double kMillimetre = 1e-3;                   ///< m
inline constexpr double kMm = 1e3;                            ///< millimetres in a metre
inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< degrees in a radian
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace snug
