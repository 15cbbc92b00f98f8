// Noise in image space: white, blurred, and smooth waves; each value depends on a key and its place alone.
#pragma once

#include <cstdint>

#include "snug/camera/grid.hpp"

namespace snug::camera::internal {

/// 64 random bits of one pixel (SplitMix64's output for the state key + index).
[[nodiscard]] inline std::uint64_t pixel_bits(std::uint64_t key, std::uint64_t index) {
  std::uint64_t z = key + (index + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Uniform in [0, 1) from the lowest 16 bits.
[[nodiscard]] inline float low_uniform(std::uint64_t bits) { return static_cast<float>(bits & 0xffffU) * 0x1.0p-16F; }

/// Mean 0, variance 1: the sum of four uniforms of 12 bits each, the highest 48. Tails end at 3.46.
[[nodiscard]] inline float near_normal(std::uint64_t bits) {
  const auto sum = static_cast<std::int32_t>((bits >> 16) & 0xfffU) + static_cast<std::int32_t>((bits >> 28) & 0xfffU) +
                   static_cast<std::int32_t>((bits >> 40) & 0xfffU) + static_cast<std::int32_t>((bits >> 52) & 0xfffU);
  constexpr float kScale = 1.0F / 2364.8F;  // standard deviation of the sum: 4096 sqrt(4 / 12)
  return (static_cast<float>(sum) - 8190.0F) * kScale;
}

/// Noise of variance 1, white at `correlation` 0, else blurred by a Gaussian of that many pixels.
[[nodiscard]] Grid2<float> blurred_noise(int rows, int cols, std::uint64_t key, double correlation, int threads);

/// A smooth field of mean 0 and variance 1 at every pixel: a cubic B-spline over independent values at knots `length`
/// pixels apart.
class Waves {
 public:
  Waves(int rows, int cols, std::uint64_t key, double length);
  /// Writes one row of `cols` values, times `scale`, onto `out`.
  void add_row(int row, float scale, float* out) const;

 private:
  struct Tap {
    int knot = 0;
    float weights[4] = {};
  };
  [[nodiscard]] static Tap tap(int pixel, double length);
  int cols_ = 0;
  double length_ = 1.0;
  std::vector<Tap> across_;
  Grid2<float> knots_;
};

}  // namespace snug::camera::internal
