// Noise in image space.
#include "snug/camera/internal/noise.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/parallel.hpp"

namespace snug::camera::internal {
namespace {

constexpr int kRowsDisturbedAtOnce = 32;

/// Weights of a Gaussian, scaled so that white noise keeps its variance; the middle one first, then outward.
std::vector<float> gaussian(double sigma) {
  if (!(sigma > 0.05)) return {1.0F};
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> weights;
  double squares = 0.0;
  for (int i = 0; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    squares += (i == 0 ? 1.0 : 2.0) * weights.back() * weights.back();
  }
  std::vector<float> result;
  for (const double w : weights) result.push_back(static_cast<float>(w / std::sqrt(squares)));
  return result;
}

}  // namespace

Grid2<float> blurred_noise(int rows, int cols, std::uint64_t key, double correlation, int threads) {
  const std::vector<float> weights = gaussian(correlation);
  const int reach = static_cast<int>(weights.size()) - 1;
  // Wider than the picture, so that its edge has full variance too.
  const int tall = rows + 2 * reach, wide = cols + 2 * reach;
  Grid2<float> across(tall, cols);
  const auto jobs = [](int count) { return (count + kRowsDisturbedAtOnce - 1) / kRowsDisturbedAtOnce; };
  parallel_for(jobs(tall), threads, [&](int job, int) {
    std::vector<float> white(static_cast<std::size_t>(wide));
    for (int r = job * kRowsDisturbedAtOnce; r < std::min(tall, (job + 1) * kRowsDisturbedAtOnce); ++r) {
      const auto first = static_cast<std::uint64_t>(r) * static_cast<std::uint64_t>(wide);
      for (int c = 0; c < wide; ++c)
        white[static_cast<std::size_t>(c)] = near_normal(pixel_bits(key, first + static_cast<std::uint64_t>(c)));
      const float* const middle = white.data() + reach;
      float* const out = across.row(r);
      for (int c = 0; c < cols; ++c) out[c] = weights[0] * middle[c];
      for (int k = 1; k <= reach; ++k) {
        const float w = weights[static_cast<std::size_t>(k)];
        for (int c = 0; c < cols; ++c) out[c] += w * (middle[c - k] + middle[c + k]);
      }
    }
  });
  if (reach == 0) return across;
  Grid2<float> noise(rows, cols);
  parallel_for(jobs(rows), threads, [&](int job, int) {
    for (int r = job * kRowsDisturbedAtOnce; r < std::min(rows, (job + 1) * kRowsDisturbedAtOnce); ++r) {
      float* const out = noise.row(r);
      const float* const middle = across.row(r + reach);
      for (int c = 0; c < cols; ++c) out[c] = weights[0] * middle[c];
      for (int k = 1; k <= reach; ++k) {
        const float w = weights[static_cast<std::size_t>(k)];
        const float *const above = across.row(r + reach - k), *const below = across.row(r + reach + k);
        for (int c = 0; c < cols; ++c) out[c] += w * (above[c] + below[c]);
      }
    }
  });
  return noise;
}

Waves::Tap Waves::tap(int pixel, double length) {
  const double x = pixel / length;
  const double t = x - std::floor(x);
  const double w[4] = {(1 - t) * (1 - t) * (1 - t) / 6.0, (3 * t * t * t - 6 * t * t + 4) / 6.0,
                       (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6.0, t * t * t / 6.0};
  const double norm = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
  Tap result;
  result.knot = static_cast<int>(std::floor(x));
  for (int i = 0; i < 4; ++i) result.weights[i] = static_cast<float>(w[i] / norm);
  return result;
}

Waves::Waves(int rows, int cols, std::uint64_t key, double length) : cols_(cols), length_(length) {
  for (int c = 0; c < cols; ++c) across_.push_back(tap(c, length));
  knots_ = Grid2<float>(tap(rows - 1, length).knot + 4, across_.back().knot + 4);
  for (std::size_t i = 0; i < knots_.values().size(); ++i) knots_.values()[i] = near_normal(pixel_bits(key, i));
}

void Waves::add_row(int row, float scale, float* out) const {
  const Tap down = tap(row, length_);
  std::vector<float> line(static_cast<std::size_t>(knots_.cols()));
  for (int k = 0; k < 4; ++k)
    for (int c = 0; c < knots_.cols(); ++c)
      line[static_cast<std::size_t>(c)] += scale * down.weights[k] * knots_(down.knot + k, c);
  for (int c = 0; c < cols_; ++c) {
    const Tap& t = across_[static_cast<std::size_t>(c)];
    const float* const knot = line.data() + t.knot;
    out[c] += t.weights[0] * knot[0] + t.weights[1] * knot[1] + t.weights[2] * knot[2] + t.weights[3] * knot[3];
  }
}

}  // namespace snug::camera::internal
