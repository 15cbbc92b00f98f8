// Smoothing: what the demonstrator's analysis does to measured columns before it compares them.
#include "snug/validation/internal/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "snug/validation/internal/averages.hpp"

namespace snug::validation::internal {
namespace {

constexpr double kScaledMad = 1.4826;  // standard deviations in a median absolute deviation of normal noise
constexpr double kOutlier = 3.0;       // the default of MATLAB's filloutliers; the analysis names no other
constexpr double kHops = 30.0;         // medians in a window
constexpr std::ptrdiff_t kHalfWindow = 25;

/// Slope at the middle of three samples: weighted harmonic mean of the two secants, 0 at an extremum.
double pchip_slope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0.0) return 0.0;
  const double w0 = 2.0 * h1 + h0, w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

}  // namespace

std::vector<bool> find_outliers(const std::vector<double>& times, const std::vector<double>& values, double window) {
  std::vector<bool> is_outlier(values.size(), false);
  std::vector<double> near;
  std::size_t begin = 0, end = 0;
  double next_hop = -std::numeric_limits<double>::infinity(), middle = 0.0, limit = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (times[i] >= next_hop) {
      next_hop = times[i] + window / kHops;
      while (begin < i && times[begin] < times[i] - 0.5 * window) ++begin;
      while (end < values.size() && times[end] <= times[i] + 0.5 * window) ++end;
      near.clear();
      for (std::size_t k = begin; k < end; ++k)
        if (std::isfinite(values[k])) near.push_back(values[k]);
      if (near.empty()) continue;
      middle = median(near);
      for (double& value : near) value = std::abs(value - middle);
      limit = kOutlier * kScaledMad * median(near);
    }
    is_outlier[i] = std::isfinite(values[i]) && std::abs(values[i] - middle) > limit;
  }
  return is_outlier;
}

void fill_gaps(const std::vector<double>& times, std::vector<double>& values) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i])) known.push_back(i);
  const auto secant = [&](std::size_t k) {
    return (values[known[k + 1]] - values[known[k]]) / (times[known[k + 1]] - times[known[k]]);
  };
  const auto slope = [&](std::size_t k) {
    if (known.size() < 3 || k == 0 || k + 1 == known.size()) return secant(k + 1 == known.size() ? k - 1 : k);
    return pchip_slope(times[known[k]] - times[known[k - 1]], times[known[k + 1]] - times[known[k]], secant(k - 1),
                       secant(k));
  };
  for (std::size_t k = 0; k + 1 < known.size(); ++k) {
    if (known[k + 1] == known[k] + 1) continue;
    const double h = times[known[k + 1]] - times[known[k]];
    const double y0 = values[known[k]], y1 = values[known[k + 1]], m0 = slope(k), m1 = slope(k + 1);
    for (std::size_t i = known[k] + 1; i < known[k + 1]; ++i) {
      const double s = (times[i] - times[known[k]]) / h;
      values[i] = (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s) * y0 + s * (1.0 - s) * (1.0 - s) * h * m0 +
                  s * s * (3.0 - 2.0 * s) * y1 - s * s * (1.0 - s) * h * m1;
    }
  }
}

std::vector<double> smooth(const std::vector<double>& values) {
  std::vector<double> smoothed(values.size());
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto at = [&](std::ptrdiff_t k) { return values[static_cast<std::size_t>(k)]; };
    std::ptrdiff_t half = 0;
    while (half < kHalfWindow && i - half - 1 >= 0 && i + half + 1 < count && std::isfinite(at(i - half - 1)) &&
           std::isfinite(at(i + half + 1)))
      ++half;
    // Weights of the value at the middle of a parabola fitted to 2 m + 1 even samples (Savitzky and Golay 1964).
    const auto m = static_cast<double>(half);
    const double norm = (2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0) / 3.0;
    double sum = 0.0;
    if (half < 2) {
      sum = at(i);  // a parabola through three samples is the samples
    } else {
      for (std::ptrdiff_t k = -half; k <= half; ++k) {
        const auto x = static_cast<double>(k);
        sum += (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * x * x) / norm * at(i + k);
      }
    }
    smoothed[static_cast<std::size_t>(i)] = sum;
  }
  return smoothed;
}

}  // namespace snug::validation::internal
