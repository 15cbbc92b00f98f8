// Noise and waves: mean, variance and correlation in closed form, and a place's value depends on nothing but the key.
#include "snug/camera/internal/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace snug::camera::internal {
namespace {

struct Moments {
  double mean = 0.0, variance = 0.0;
};

Moments moments_of(const Grid2<float>& grid) {
  Moments moments;
  const auto count = static_cast<double>(grid.values().size());
  for (const float value : grid.values()) moments.mean += value / count;
  for (const float value : grid.values()) moments.variance += (value - moments.mean) * (value - moments.mean) / count;
  return moments;
}

/// Correlation of pixels `columns` apart.
double correlation_of(const Grid2<float>& grid, int columns) {
  double products = 0.0, squares = 0.0;
  for (int r = 0; r < grid.rows(); ++r)
    for (int c = 0; c + columns < grid.cols(); ++c) {
      products += grid(r, c) * grid(r, c + columns);
      squares += grid(r, c) * grid(r, c);
    }
  return products / squares;
}

TEST(PixelBits, DifferForEveryPixelAndEveryKey) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t key = 0; key < 20; ++key)
    for (std::uint64_t index = 0; index < 500; ++index) seen.insert(pixel_bits(key * 0x123456789ULL, index));
  EXPECT_EQ(seen.size(), 10'000u);
}

TEST(LowUniform, IsWithinTheUnitIntervalAndEven) {
  double sum = 0.0;
  constexpr int kCount = 100'000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const float u = low_uniform(pixel_bits(7, i));
    ASSERT_GE(u, 0.0F);
    ASSERT_LT(u, 1.0F);
    sum += u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 4.0 / std::sqrt(12.0 * kCount)) << "four standard errors";
}

/// Four uniforms: mean 0, variance 1, kurtosis 3 - 6 / (5 * 4), tails that end at 8190 / 2364.8.
TEST(NearNormal, HasTheMomentsOfASumOfFourUniforms) {
  double sum = 0.0, squares = 0.0, fourth = 0.0, largest = 0.0;
  constexpr int kCount = 200'000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double x = near_normal(pixel_bits(11, i));
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    largest = std::max(largest, std::abs(x));
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 4.0 * std::sqrt(1.7 / kCount));  // variance of a square: kurtosis - 1
  EXPECT_NEAR(fourth / kCount, 2.7, 0.05);
  EXPECT_LE(largest, 3.4634);
}

TEST(BlurredNoise, HasVarianceOneAtAnyBlurAlsoAtItsEdge) {
  for (const double sigma : {0.0, 0.7, 2.0}) {
    const Grid2<float> noise = blurred_noise(300, 400, 5, sigma, 1);
    const Moments all = moments_of(noise);
    const double independent = 120'000.0 / std::max(1.0, 4.0 * 3.14159265 * sigma * sigma);
    EXPECT_NEAR(all.mean, 0.0, 5.0 / std::sqrt(independent)) << sigma;
    EXPECT_NEAR(all.variance, 1.0, 5.0 * std::sqrt(2.0 / independent)) << sigma;
    Grid2<float> rim(1, 400);
    for (int c = 0; c < 400; ++c) rim(0, c) = noise(0, c);
    EXPECT_NEAR(moments_of(rim).variance, 1.0, 5.0 * std::sqrt(2.0 / (400.0 / std::max(1.0, 3.5 * sigma)))) << sigma;
  }
}

/// White noise blurred by a Gaussian of sigma: correlation exp(-d^2 / (4 sigma^2)).
TEST(BlurredNoise, IsCorrelatedAsABlurMakesIt) {
  for (const double sigma : {1.0, 2.0}) {
    const Grid2<float> noise = blurred_noise(400, 600, 9, sigma, 1);
    for (const int d : {1, 2, 4}) {
      EXPECT_NEAR(correlation_of(noise, d), std::exp(-d * d / (4.0 * sigma * sigma)), 0.03) << sigma << " " << d;
    }
  }
  EXPECT_NEAR(correlation_of(blurred_noise(400, 600, 9, 0.0, 1), 1), 0.0, 0.01);
}

TEST(BlurredNoise, IsTheSameAtAnyNumberOfThreadsAndAnotherForAnotherKey) {
  const Grid2<float> one = blurred_noise(97, 131, 3, 1.3, 1);
  EXPECT_EQ(one, blurred_noise(97, 131, 3, 1.3, 4));
  EXPECT_NE(one, blurred_noise(97, 131, 4, 1.3, 1));
}

Grid2<float> waves_of(int rows, int cols, std::uint64_t key, double length, float scale = 1.0F) {
  Grid2<float> grid(rows, cols);
  const Waves waves(rows, cols, key, length);
  for (int r = 0; r < rows; ++r) waves.add_row(r, scale, grid.row(r));
  return grid;
}

/// Over many fields each pixel has mean 0 and variance 1, at knots and between them.
TEST(Waves, HaveVarianceOneAtEveryPixel) {
  constexpr int kFields = 4000;
  double squares[3] = {}, sums[3] = {};
  for (std::uint64_t key = 0; key < kFields; ++key) {
    const Grid2<float> field = waves_of(1, 12, 1000 + key, 8.0);
    for (int k = 0; k < 3; ++k) {
      const double value = field(0, 4 * k);
      sums[k] += value / kFields;
      squares[k] += value * value / kFields;
    }
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sums[k], 0.0, 4.0 / std::sqrt(kFields)) << k;
    EXPECT_NEAR(squares[k], 1.0, 4.0 * std::sqrt(2.0 / kFields)) << k;
  }
}

TEST(Waves, AreSmoothAndScale) {
  const Grid2<float> field = waves_of(60, 80, 3, 20.0);
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c + 1 < 80; ++c)
      EXPECT_LT(std::abs(field(r, c + 1) - field(r, c)), 0.5F) << "a twentieth of a knot";
  const Grid2<float> twice = waves_of(60, 80, 3, 20.0, 2.0F);
  for (std::size_t i = 0; i < field.values().size(); ++i)
    EXPECT_NEAR(twice.values()[i], 2.0F * field.values()[i], 1e-5F);
}

TEST(Waves, AddToWhatIsThere) {
  Grid2<float> grid(1, 30, 5.0F);
  const Waves waves(1, 30, 3, 10.0);
  waves.add_row(0, 1.0F, grid.row(0));
  const Grid2<float> alone = waves_of(1, 30, 3, 10.0);
  for (int c = 0; c < 30; ++c) EXPECT_NEAR(grid(0, c), 5.0F + alone(0, c), 1e-5F);
}

}  // namespace
}  // namespace snug::camera::internal
