// SmoothedSamples against closed forms: lines, exact curves, noise of known size, dense algebra.
#include "snug/numerics/smoothed_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::numerics {
namespace {

std::vector<double> uneven_times(int count, Rng& rng) {
  std::vector<double> times{0.0};
  while (static_cast<int>(times.size()) < count) times.push_back(times.back() + rng.uniform(0.004, 0.012));
  return times;
}

/// Rests, speeds up, goes straight, brakes within 80 ms.
double pushed(double t) {
  const auto ramp = [](double s) { return s <= 0.0 ? 0.0 : s >= 1.0 ? s - 0.5 : s * s * s - 0.5 * s * s * s * s; };
  return 0.4 * (0.2 * ramp((t - 0.15) / 0.2) - 0.08 * ramp((t - 0.75) / 0.08));
}

TEST(SmoothedSamples, NoiseIsFoundAndMostOfItTakenOut) {
  double worst = 0.0, off = 0.0, in_bandwidth = 0.0;
  constexpr int kSeeds = 20;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const std::vector<double> times = uneven_times(200, rng);
    Eigen::MatrixXd exact(200, 3), samples(200, 3);
    for (Eigen::Index i = 0; i < 200; ++i) {
      const double t = times[static_cast<std::size_t>(i)];
      exact.row(i) << pushed(t), -0.3 * pushed(t), 0.05;
      for (Eigen::Index j = 0; j < 3; ++j) samples(i, j) = exact(i, j) + 1e-4 * rng.normal();
    }
    const SmoothedSamples found = smooth_samples(times, samples);
    worst = std::max(worst, std::abs(found.noise / 1e-4 - 1.0));
    off += (found.values - exact).norm() / std::sqrt(600.0) / kSeeds;
    in_bandwidth += found.bandwidth() / kSeeds;
  }
  // 600 numbers tell a deviation to 3 %: four of its own.
  EXPECT_LT(worst, 0.12);
  EXPECT_LT(off, 0.45e-4);
  EXPECT_GT(in_bandwidth, 2.0);
  EXPECT_LT(in_bandwidth, 20.0);
}

TEST(SmoothedSamples, LinesStayAndExactSamplesAreFollowed) {
  Rng rng(3);
  const std::vector<double> times = uneven_times(60, rng);
  Eigen::MatrixXd line(60, 2), curve(60, 1);
  for (Eigen::Index i = 0; i < 60; ++i) {
    const double t = times[static_cast<std::size_t>(i)];
    line.row(i) << 0.1 + 2.0 * t, -t;
    curve(i, 0) = std::sin(30.0 * t);
  }
  EXPECT_LT((smooth_samples(times, line).values - line).cwiseAbs().maxCoeff(), 1e-12);
  // What smoothing changes of a curve is far below what is between its samples: (30 * 8 ms)^4 / 384 of a cubic.
  EXPECT_LT((smooth_samples(times, curve).values - curve).cwiseAbs().maxCoeff(), 1e-5);
  const Eigen::MatrixXd few = line.topRows(4);
  EXPECT_EQ(smooth_samples({times.begin(), times.begin() + 4}, few).values, few);
  EXPECT_EQ(smooth_samples({0.5}, line.topRows(1)).values, Eigen::MatrixXd(line.topRows(1)));
}

TEST(SmoothedSamples, BandsAgreeWithDenseAlgebra) {
  Rng rng(5);
  const std::vector<double> times = uneven_times(12, rng);
  SmoothedSamples model;
  model.times = times;
  model.stiffness = Eigen::VectorXd::NullaryExpr(10, [&] { return std::pow(10.0, rng.uniform(-9.0, -6.0)); });
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(10, 12);
  for (Eigen::Index j = 0; j < 10; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const double a = times[k + 1] - times[k], b = times[k + 2] - times[k + 1];
    D(j, j) = 2.0 / (a * (a + b)), D(j, j + 1) = -2.0 / (a * b), D(j, j + 2) = 2.0 / (b * (a + b));
  }
  const Eigen::MatrixXd smoother =
      invert_symmetric(Eigen::MatrixXd::Identity(12, 12) + D.transpose() * model.stiffness.asDiagonal() * D);
  const Eigen::MatrixXd samples = Eigen::MatrixXd::NullaryExpr(12, 2, [&] { return rng.normal(); });
  const SmoothedSamples found = smooth_alike(model, samples);
  EXPECT_LT((found.values - smoother * samples).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(found.unknowns, smoother.trace(), 1e-9);
}

TEST(SmoothedSamples, AddingALineChangesNothingElse) {
  Rng rng(8);
  const std::vector<double> times = uneven_times(80, rng);
  Eigen::MatrixXd samples(80, 1), moved(80, 1);
  for (Eigen::Index i = 0; i < 80; ++i) {
    const double t = times[static_cast<std::size_t>(i)];
    samples(i, 0) = pushed(t) + 1e-4 * rng.normal();
    moved(i, 0) = samples(i, 0) + 0.3 - 0.7 * t;
  }
  const SmoothedSamples a = smooth_samples(times, samples), b = smooth_samples(times, moved);
  EXPECT_NEAR(a.unknowns, b.unknowns, 1e-6);
  EXPECT_NEAR(a.noise, b.noise, 1e-9);
}

}  // namespace
}  // namespace snug::numerics
