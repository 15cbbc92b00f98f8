// Outliers: which measurements no noise of the others explains.
#pragma once

#include <cstddef>
#include <vector>

namespace snug::numerics {

/// Standard deviation of each of `degrees` (3 or 6) normal numbers whose norms are `sizes`, by the median: up to half
/// of the sizes may be anything. `sizes` must not be empty.
[[nodiscard]] double median_deviation(std::vector<double> sizes, int degrees);

/// Indices of the sizes beyond 6 standard deviations of the rest; deviations below `floor` (rounding of exact data)
/// count as that. `unknowns`: how many were fitted to the numbers that the sizes are left of; the median of few
/// residuals is then too small, and is enlarged by 1 + 5 / (sizes - unknowns / degrees) (Rousseeuw and Leroy, Robust
/// Regression and Outlier Detection, 1987, chapter 5).
[[nodiscard]] std::vector<std::size_t> find_outliers(const std::vector<double>& sizes, int degrees, double floor,
                                                     int unknowns = 0);

}  // namespace snug::numerics
