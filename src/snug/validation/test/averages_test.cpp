// Averages and smoothing: closed forms, symmetry, and a second opinion by linear algebra.
#include "snug/validation/internal/averages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "snug/core/rng.hpp"
#include "snug/validation/internal/smoothing.hpp"

namespace snug::validation::internal {
namespace {

using record::PoseSample;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

Vector3 random_vector(Rng& rng, double size) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return size * Vector3(x, y, z);
}

TEST(MeanPose, IsThatOfPosesAroundIt) {
  Rng rng = Rng(1).split("mean pose");
  for (int i = 0; i < 50; ++i) {
    const Pose truth{exp_rotation(random_vector(rng, 1.5)), random_vector(rng, 1.0)};
    std::vector<PoseSample> poses;
    for (int k = 0; k < 40; ++k) {  // in pairs about the truth: their mean is the truth itself
      const Vector3 w = random_vector(rng, 0.02), p = random_vector(rng, 0.01);
      for (const double sign : {-1.0, 1.0}) {
        PoseSample pose(Pose{truth.R * exp_rotation(sign * w), truth.p + sign * p});
        if (rng.index(2) == 0) pose.quat.coeffs() = -pose.quat.coeffs();  // the same rotation
        poses.push_back(pose);
      }
    }
    const std::optional<Pose> mean = mean_pose(poses, 0.5);
    ASSERT_TRUE(mean);
    EXPECT_LT((mean->p - truth.p).norm(), 1e-12);
    EXPECT_LT(angle_between(mean->R, truth.R), 1e-9);
  }
}

TEST(MeanPose, IsMovedWithItsPoses) {
  Rng rng = Rng(2).split("mean pose");
  std::vector<PoseSample> poses, moved;
  const Pose X{exp_rotation(random_vector(rng, 1.0)), random_vector(rng, 2.0)};
  for (int k = 0; k < 11; ++k) {
    const Pose pose{exp_rotation(random_vector(rng, 0.2)), random_vector(rng, 0.2)};
    poses.emplace_back(pose);
    moved.emplace_back(X * pose);
  }
  const Pose expected = X * *mean_pose(poses, 0.5), found = *mean_pose(moved, 0.5);
  EXPECT_LT((expected.p - found.p).norm(), 1e-12);
  EXPECT_LT(angle_between(expected.R, found.R), 1e-9);
}

TEST(MeanPose, IsNoneWhereTooFewAreTracked) {
  std::vector<PoseSample> poses(10, record::lost_pose());
  EXPECT_FALSE(mean_pose(poses, 0.0));
  EXPECT_FALSE(mean_pose({}, 0.5));
  for (int k = 0; k < 4; ++k) poses[static_cast<std::size_t>(k)] = PoseSample(Pose{});
  EXPECT_FALSE(mean_pose(poses, 0.5));
  poses[4] = PoseSample(Pose{});
  EXPECT_TRUE(mean_pose(poses, 0.5));
}

/// Of n poses with deviation s in each axis: s / sqrt(n).
TEST(FindMeanError, ShrinksWithTheRootOfTheirNumber) {
  Rng rng = Rng(3).split("mean error");
  for (const int count : {25, 400}) {
    std::vector<PoseSample> poses;
    for (int k = 0; k < count; ++k)
      poses.emplace_back(Pose{exp_rotation(random_vector(rng, 0.01)), random_vector(rng, 0.004)});
    const MeanPoseError error = find_mean_error(poses, *mean_pose(poses, 0.5));
    const double relative = 4.0 / std::sqrt(2.0 * 3.0 * count);  // of a standard deviation, four standard errors
    EXPECT_NEAR(error.position * std::sqrt(count) / 0.004, 1.0, relative) << count;
    EXPECT_NEAR(error.rotation * std::sqrt(count) / 0.01, 1.0, relative) << count;
  }
}

TEST(Median, IsTheMiddleOneInAnyOrder) {
  std::vector<double> none;
  EXPECT_EQ(median(none), 0.0);
  Rng rng = Rng(4).split("median");
  for (int count = 1; count < 40; ++count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    std::iota(values.begin(), values.end(), 0.0);
    for (std::size_t i = values.size(); i-- > 1;)
      std::swap(values[i], values[static_cast<std::size_t>(rng.index(static_cast<int>(i) + 1))]);
    EXPECT_EQ(median(values), count / 2);
  }
}

/// Least squares of a parabola through the known samples of [first, end), solved as such: the value at `at`.
double parabola_at(const std::vector<double>& values, std::size_t first, std::size_t end, std::size_t at) {
  std::vector<std::size_t> known;
  for (std::size_t i = first; i < end; ++i)
    if (std::isfinite(values[i])) known.push_back(i);
  const auto rows = static_cast<Eigen::Index>(known.size());
  Eigen::MatrixXd A(rows, 3);
  Eigen::VectorXd b(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double x = static_cast<double>(known[static_cast<std::size_t>(i)]) - static_cast<double>(at);
    A.row(i) << 1.0, x, x * x;
    b(i) = values[known[static_cast<std::size_t>(i)]];
  }
  return (A.transpose() * A).ldlt().solve(A.transpose() * b)(0);
}

TEST(Smooth, IsTheParabolaOfLeastSquaresThrough25SamplesBeforeAnd24After) {
  Rng rng = Rng(5).split("smooth");
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) values.push_back(std::sin(0.05 * i) + 0.1 * rng.normal());
  const std::vector<double> smoothed = smooth(values);
  for (const std::size_t i : {30u, 77u, 150u, 174u})
    EXPECT_NEAR(smoothed[i], parabola_at(values, i - 25, i + 25, i), 1e-9);
  EXPECT_NEAR(smoothed[10], parabola_at(values, 0, 35, 10), 1e-9) << "what there is of them at the ends";
  EXPECT_NEAR(smoothed[0], parabola_at(values, 0, 25, 0), 1e-9);
  EXPECT_NEAR(smoothed[199], parabola_at(values, 174, 200, 199), 1e-9);
  values[100] = kMissing;
  EXPECT_NEAR(smooth(values)[90], parabola_at(values, 65, 115, 90), 1e-9);
  EXPECT_TRUE(std::isnan(smooth(values)[100])) << "what is missing is not made up here";
  EXPECT_EQ(smooth({1.0, 5.0}), (std::vector<double>{1.0, 5.0})) << "too few for a parabola";
}

TEST(FillGaps, IsExactOnLinesAndKeepsWhatIsKnown) {
  std::vector<double> times, values;
  for (int i = 0; i < 50; ++i) {
    times.push_back(0.01 * i + (i % 3) * 0.001);
    values.push_back(3.0 - 7.0 * times.back());
  }
  const std::vector<double> whole = values;
  for (const std::size_t i : {5u, 6u, 7u, 20u, 40u, 41u}) values[i] = kMissing;
  fill_gaps(times, values);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], whole[i], 1e-12) << i;
  std::vector<double> ends = {kMissing, 1.0, kMissing, 3.0, kMissing};
  fill_gaps({0, 1, 2, 3, 4}, ends);
  EXPECT_TRUE(std::isnan(ends[0]) && std::isnan(ends[4]));
  EXPECT_NEAR(ends[2], 2.0, 1e-12);
  std::vector<double> alone = {kMissing, 1.0, kMissing}, none = {kMissing, kMissing};
  fill_gaps({0, 1, 2}, alone);
  fill_gaps({0, 1}, none);
  EXPECT_EQ(alone[1], 1.0);
}

TEST(FindOutliers, AreThoseBeyondThreeScaledDeviationsOfTheMedian) {
  Rng rng = Rng(7).split("outliers");
  std::vector<double> times, values;
  for (int i = 0; i < 2000; ++i) {
    times.push_back(0.008 * i);
    values.push_back(rng.normal());
  }
  const std::vector<bool> usual = find_outliers(times, values, 3.0);
  // Beyond three deviations lies 0.27 % of normal noise: 5.4 of 2000; the median's own scatter makes it a few more.
  EXPECT_LT(std::ranges::count(usual, true), 30);
  for (const std::size_t i : {100u, 900u, 1999u}) values[i] += 8.0;
  values[500] = kMissing;
  const std::vector<bool> found = find_outliers(times, values, 3.0);
  for (const std::size_t i : {100u, 900u, 1999u}) EXPECT_TRUE(found[i]) << i;
  EXPECT_FALSE(found[500]);
  const std::vector<bool> shifted = [&] {
    std::vector<double> scaled;
    for (const double value : values) scaled.push_back(1e3 * value - 77.0);
    return find_outliers(times, scaled, 3.0);
  }();
  EXPECT_EQ(shifted, found) << "units do not matter";
  // Sample by sample, by sorting.
  std::vector<bool> sorted(values.size(), false);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double> near;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (std::abs(times[k] - times[i]) <= 1.5 && std::isfinite(values[k])) near.push_back(values[k]);
    const double middle = median(near);
    for (double& value : near) value = std::abs(value - middle);
    sorted[i] = std::abs(values[i] - middle) > 3.0 * 1.4826 * median(near);
  }
  EXPECT_EQ(found, sorted);
}

}  // namespace
}  // namespace snug::validation::internal
