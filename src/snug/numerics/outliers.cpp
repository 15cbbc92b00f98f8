// Outliers against a deviation taken from the median.
#include "snug/numerics/outliers.hpp"

#include <algorithm>

#include "snug/core/check.hpp"

namespace snug::numerics {

constexpr double kOutlierDeviations = 6.0;  // chance of 1e-7 in three normal numbers, 3e-6 in six

double median_deviation(std::vector<double> sizes, int degrees) {
  SNUG_CHECK(degrees == 3 || degrees == 6, "median known for 3 and 6 degrees of freedom");
  const double median_norm = degrees == 3 ? 1.5382 : 2.3126;  // square roots of the medians of chi-square
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  return sizes[sizes.size() / 2] / median_norm;
}

std::vector<std::size_t> find_outliers(const std::vector<double>& sizes, int degrees, double floor, int unknowns) {
  const double left = static_cast<double>(sizes.size()) - static_cast<double>(unknowns) / degrees;
  const double few = unknowns > 0 ? 1.0 + 5.0 / std::max(1.0, left) : 1.0;
  const double limit = kOutlierDeviations * std::max(floor, few * median_deviation(sizes, degrees));
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    if (sizes[k] > limit) found.push_back(k);
  return found;
}

}  // namespace snug::numerics
