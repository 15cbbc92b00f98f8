// Smoothing: what the demonstrator's analysis does to measured columns before it compares them.
#include "snug/validation/internal/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace snug::validation::internal {
namespace {

constexpr double kScaledMad = 1.4826;  // standard deviations in a median absolute deviation of normal noise
constexpr double kOutlier = 3.0;       // the default of MATLAB's filloutliers; the analysis names no other
constexpr std::ptrdiff_t kBefore = 25, kAfter = 24;  // samples of a window of 50, as MATLAB centres an even one

/// Slope at the middle of three samples: weighted harmonic mean of the two secants, 0 at an extremum.
double pchip_slope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0.0) return 0.0;
  const double w0 = 2.0 * h1 + h0, w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

/// The known values of a moving window, in order.
class SortedWindow {
 public:
  void add(double value) { values_.insert(std::ranges::upper_bound(values_, value), value); }
  void take_away(double value) { values_.erase(std::ranges::lower_bound(values_, value)); }
  [[nodiscard]] double median() const {
    const std::size_t n = values_.size();
    return n % 2 == 1 ? values_[n / 2] : 0.5 * (values_[n / 2 - 1] + values_[n / 2]);
  }
  /// Median of the absolute deviations from `middle`, the median.
  [[nodiscard]] double deviation_from(double middle) const {
    const std::size_t n = values_.size();
    const double upper = deviation(middle, n / 2);
    return n % 2 == 1 ? upper : 0.5 * (deviation(middle, n / 2 - 1) + upper);
  }

 private:
  /// The deviation that has `rank` smaller ones. Deviations grow from the middle to both sides: of the smallest
  /// rank + 1, so many stand below it as a bisection says.
  [[nodiscard]] double deviation(double middle, std::size_t rank) const {
    const auto split = static_cast<std::size_t>(std::ranges::lower_bound(values_, middle) - values_.begin());
    const std::size_t n = values_.size(), wanted = rank + 1;
    const auto below = [&](std::size_t k) { return middle - values_[split - 1 - k]; };
    const auto above = [&](std::size_t k) { return values_[split + k] - middle; };
    std::size_t low = wanted > n - split ? wanted - (n - split) : 0, high = std::min(wanted, split);
    while (low < high) {  // the fewest below whose next one is no smaller than the last above
      const std::size_t k = (low + high) / 2;
      if (below(k) < above(wanted - k - 1))
        low = k + 1;
      else
        high = k;
    }
    const std::size_t others = wanted - low;
    return std::max(low > 0 ? below(low - 1) : 0.0, others > 0 ? above(others - 1) : 0.0);
  }

  std::vector<double> values_;
};

/// The value at 0 of the parabola of least squares through the known samples from -before to after around `middle`.
double parabola_at(const std::vector<double>& values, std::ptrdiff_t middle, std::ptrdiff_t before,
                   std::ptrdiff_t after) {
  // Normal equations in x / reach, solved by Cramer's rule.
  const double reach = static_cast<double>(kBefore);
  double s[5] = {}, b[3] = {};
  for (std::ptrdiff_t k = -before; k <= after; ++k) {
    const double y = values[static_cast<std::size_t>(middle + k)], x = static_cast<double>(k) / reach;
    if (!std::isfinite(y)) continue;
    double power = 1.0;
    for (int j = 0; j < 5; ++j, power *= x) {
      s[j] += power;
      if (j < 3) b[j] += power * y;
    }
  }
  if (s[0] < 3.0) return values[static_cast<std::size_t>(middle)];
  const double c0 = s[2] * s[4] - s[3] * s[3], c1 = s[2] * s[3] - s[1] * s[4], c2 = s[1] * s[3] - s[2] * s[2];
  return (c0 * b[0] + c1 * b[1] + c2 * b[2]) / (c0 * s[0] + c1 * s[1] + c2 * s[2]);
}

}  // namespace

std::vector<bool> find_outliers(const std::vector<double>& times, const std::vector<double>& values, double window) {
  std::vector<bool> is_outlier(values.size(), false);
  SortedWindow near;
  std::size_t begin = 0, end = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (; end < values.size() && times[end] <= times[i] + 0.5 * window; ++end)
      if (std::isfinite(values[end])) near.add(values[end]);
    for (; times[begin] < times[i] - 0.5 * window; ++begin)
      if (std::isfinite(values[begin])) near.take_away(values[begin]);
    if (!std::isfinite(values[i])) continue;
    const double middle = near.median();
    is_outlier[i] = std::abs(values[i] - middle) > kOutlier * kScaledMad * near.deviation_from(middle);
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
  std::vector<double> smoothed(values);
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double& value = smoothed[static_cast<std::size_t>(i)];
    if (std::isfinite(value)) value = parabola_at(values, i, std::min(i, kBefore), std::min(count - 1 - i, kAfter));
  }
  return smoothed;
}

}  // namespace snug::validation::internal
