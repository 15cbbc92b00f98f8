// Smoothing: what the demonstrator's analysis does to measured columns before it compares them.
#pragma once

#include <vector>

namespace snug::validation::internal {

/// Samples that lie more than three scaled median absolute deviations off the median of the `window` seconds around
/// each of them.
[[nodiscard]] std::vector<bool> find_outliers(const std::vector<double>& times, const std::vector<double>& values,
                                              double window);

/// Fills what is missing between two samples with the monotone cubic of Fritsch and Carlson (pchip); what is missing
/// at the ends stays so.
void fill_gaps(const std::vector<double>& times, std::vector<double>& values);

/// Savitzky-Golay filter of second order over the demonstrator's 50 samples: the sample, 25 before and 24 after it;
/// those of them that there are at the ends and beside gaps.
[[nodiscard]] std::vector<double> smooth(const std::vector<double>& values);

}  // namespace snug::validation::internal
