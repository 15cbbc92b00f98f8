// Perception against closed forms: noise coordinate by coordinate, covariances as matrices, columns against rays.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/perception/perception.hpp"

namespace snug::perception {
namespace {

/// One box, turned about all axes.
Scene tilted_box() {
  Scene scene;
  scene.boxes.push_back({"A", Pose{exp_rotation(Vector3(0.4, -0.2, 0.9)), Vector3(0.1, 0.2, 0.3)}, {0.2, 0.1, 0.15}});
  return scene;
}

Vector6 error_of(const PoseEstimate& seen, const SceneBox& is) {
  Vector6 error;
  error << seen.X_WP.p - is.X_WP.p, log_rotation(seen.X_WP.R * is.X_WP.R.transpose());
  return error;
}

void expect_covariance(const Matrix6& covariance) {
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_EQ(covariance, Matrix6(covariance.transpose()));
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix6>(covariance).eigenvalues().minCoeff(), 0.0);
}

TEST(Noise, HasNoMeanAndNoCoordinateSaysAnythingOfAnother) {
  const Scene scene = tilted_box();
  const auto noisy = make_perception(Kind::Noisy, 3);
  constexpr int kLooks = 3000;
  Eigen::Matrix<double, 9, 1> mean = Eigen::Matrix<double, 9, 1>::Zero();
  Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
  for (int look = 0; look < kLooks; ++look) {
    const Observation seen = noisy->perceive(scene, {});
    Eigen::Matrix<double, 9, 1> error;  // of pose and edges, in deviations
    error << error_of(seen.seen[0], scene.boxes[0]), *seen.seen[0].size - scene.boxes[0].size;
    error.head<6>().array() /= seen.seen[0].covariance.diagonal().array().sqrt();
    error.tail<3>() /= seen.seen[0].size_deviation;
    mean += error / kLooks;
    square += error * error.transpose() / kLooks;
    if (look == 0) expect_covariance(seen.seen[0].covariance);
  }
  const double five = 5.0 / std::sqrt(static_cast<double>(kLooks));
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(mean[i], 0.0, five) << i;
    for (int j = 0; j < 9; ++j) EXPECT_NEAR(square(i, j), i == j ? 1.0 : 0.0, five) << i << ", " << j;
  }
}

TEST(Noise, OfOneBoxSaysNothingOfThatOfAnother) {
  Scene scene = tilted_box();
  scene.boxes.push_back({"B", Pose{Matrix3::Identity(), Vector3(0.5, 0.0, 0.1)}, {0.1, 0.1, 0.1}});
  const auto noisy = make_perception(Kind::Noisy, 3);
  constexpr int kLooks = 2000;
  Matrix6 both = Matrix6::Zero();
  for (int look = 0; look < kLooks; ++look) {
    const Observation seen = noisy->perceive(scene, {});
    both += error_of(seen.seen[0], scene.boxes[0]) * error_of(seen.seen[1], scene.boxes[1]).transpose() / kLooks;
    EXPECT_TRUE(seen.seen[0].common.isZero(0.0)) << "it has nothing in common";
  }
  const NoiseLevels noise;
  const double five = 5.0 / std::sqrt(static_cast<double>(kLooks)) / 3.0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double scale = (i < 3 ? noise.position : noise.rotation) * (j < 3 ? noise.position : noise.rotation);
      EXPECT_NEAR(both(i, j) / scale, 0.0, five) << i << ", " << j;
    }
  }
}

TEST(Noise, OfNoWidthIsTheTruthAndSaysSo) {
  const Scene scene = tilted_box();
  const Observation seen = make_perception(Kind::Noisy, 3, {0.0, 0.0, 0.0})->perceive(scene, {});
  const Observation exact = make_perception(Kind::Exact, 3)->perceive(scene, {});
  EXPECT_LT(error_of(seen.seen[0], scene.boxes[0]).norm(), 1e-12);
  EXPECT_EQ(seen.seen[0].size, exact.seen[0].size);
  EXPECT_TRUE(seen.seen[0].covariance.isZero(0.0));
  EXPECT_EQ(seen.seen[0].size_deviation, 0.0);
}

TEST(Noise, GrowsWithItsWidths) {
  const Scene scene = tilted_box();
  const NoiseLevels levels{0.006, 0.06, 0.003};
  const Observation seen = make_perception(Kind::Noisy, 3, levels)->perceive(scene, {});
  expect_covariance(seen.seen[0].covariance);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(seen.seen[0].covariance(i, i), 0.006 * 0.006 / 3.0, 1e-15);
    EXPECT_NEAR(seen.seen[0].covariance(i + 3, i + 3), 0.06 * 0.06 / 3.0, 1e-15);
  }
  EXPECT_NEAR(seen.seen[0].size_deviation, 0.003 / std::sqrt(3.0), 1e-15);
}

TEST(Noise, KeepsRotationsRotations) {
  const Scene scene = tilted_box();
  const auto noisy = make_perception(Kind::Noisy, 9, {0.01, 1.0, 0.01});
  for (int look = 0; look < 200; ++look) {
    const Matrix3 R = noisy->perceive(scene, {}).seen[0].X_WP.R;
    EXPECT_TRUE((R * R.transpose()).isApprox(Matrix3::Identity(), 1e-12));
    EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  }
}

TEST(Looks, OfAnEmptyCellSeeNothingAndMissWhatWasExpectedInItsOrder) {
  const std::vector<Expectation> expected{{"B", {0.1, 0.1, 0.1}, {}}, {"A", {0.1, 0.1, 0.1}, {}}};
  for (const Kind kind : {Kind::Exact, Kind::Noisy, Kind::DeadReckoning}) {
    const Observation seen = make_perception(kind, 1)->perceive({}, expected);
    EXPECT_TRUE(seen.seen.empty()) << name_of(kind);
    EXPECT_EQ(seen.not_seen, (std::vector<std::string>{"B", "A"})) << name_of(kind);
    EXPECT_EQ(seen.missing.size(), kind == Kind::DeadReckoning ? 0U : 2U) << name_of(kind);
    EXPECT_EQ(seen.fault, LookFault::None);
  }
}

TEST(Looks, DependOnTheSceneAndNotOnWhatIsExpected) {
  const Scene scene = tilted_box();
  const std::vector<Expectation> wrong{{"A", {9.0, 9.0, 9.0}, Pose{Matrix3::Identity(), Vector3(5.0, 5.0, 5.0)}}};
  for (const Kind kind : {Kind::Exact, Kind::Noisy}) {
    const Observation told = make_perception(kind, 4)->perceive(scene, wrong);
    const Observation untold = make_perception(kind, 4)->perceive(scene, {});
    EXPECT_EQ(told.seen, untold.seen) << name_of(kind);
    EXPECT_TRUE(told.not_seen.empty());
  }
}

TEST(Looks, BoxesOfOneNameAreAllSeenAndTheFirstIsFound) {
  Scene scene = tilted_box();
  scene.boxes.push_back({"A", Pose{}, {0.1, 0.1, 0.1}});
  const Observation seen = make_perception(Kind::Exact, 1)->perceive(scene, {});
  EXPECT_EQ(seen.seen.size(), 2U);
  EXPECT_EQ(find(seen, "A")->X_WP, scene.boxes[0].X_WP);
  EXPECT_EQ(find(seen, ""), nullptr);
}

TEST(Looks, KindsSayTheirNames) {
  for (const Kind kind : {Kind::Exact, Kind::Noisy, Kind::DeadReckoning}) {
    EXPECT_EQ(make_perception(kind, 1)->name(), name_of(kind));
  }
  for (const char* word : {"", "Exact", "exact ", "noisy,exact", "camera2"}) {
    EXPECT_THROW((void)kind_of(word), InputError) << word;
  }
  EXPECT_EQ(kind_of("camera"), Kind::Camera);
  EXPECT_DEATH((void)make_perception(Kind::Camera, 1), "has to know the cell");
  EXPECT_STREQ(name_of(LookFault::TooFewPoints), "too few points");
  EXPECT_STREQ(name_of(LookFault::ViewBlocked), "view blocked");
}

// Columns.

/// m, of a vertical ray at (x, y): the highest point of the box on it. How far a point is out of the box is convex
/// along the ray: least by a search in thirds, and above that the face by halves.
std::optional<double> top_by_search(const Pose& X_WP, const Vector3& size, double x, double y) {
  const Pose X_PW = X_WP.inverse();
  const auto out = [&](double z) { return ((X_PW * Vector3(x, y, z)).cwiseAbs() - 0.5 * size).maxCoeff(); };
  double low = X_WP.p.z() - size.norm(), high = X_WP.p.z() + size.norm();
  for (int step = 0; step < 120; ++step) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (out(a) > out(b) ? low : high) = out(a) > out(b) ? a : b;
  }
  if (out(low) > 0.0) return std::nullopt;
  high = X_WP.p.z() + size.norm();
  for (int step = 0; step < 60; ++step) (out(0.5 * (low + high)) <= 0.0 ? low : high) = 0.5 * (low + high);
  return low;
}

TEST(ColumnsOfABox, AreAsHighAsRaysSayHoweverItLies) {
  Rng rng = Rng(8).split("columns");
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    const auto any = [&](double low, double high) {
      return Vector3(rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high));
    };
    const Pose X_WP{exp_rotation(any(-2.0, 2.0)), any(-0.3, 0.3)};
    const Vector3 size = any(0.03, 0.12);
    const std::vector<Column> columns = columns_of_box(X_WP, size);
    ASSERT_FALSE(columns.empty());
    for (const Column& one : columns) {
      std::optional<double> top;
      for (int i = 0; i < 9; ++i) {
        const auto here =
            top_by_search(X_WP, size, (one.x + 0.5 * (i % 3)) * kColumnSide, (one.y + 0.5 * (i / 3)) * kColumnSide);
        if (here && (!top || *here > *top)) top = here;
      }
      ASSERT_TRUE(top);
      EXPECT_NEAR(one.top, *top, 1e-9);
      EXPECT_LE(one.top, X_WP.p.z() + 0.5 * (X_WP.R.cwiseAbs() * size).z() + 1e-12);
    }
    EXPECT_TRUE(std::ranges::is_sorted(columns, [](const Column& a, const Column& b) {
      return a.y != b.y ? a.y < b.y : a.x < b.x;
    })) << "by y, then x";
  }
}

/// Area times height of a level box, within a rim of columns that are touched in part.
TEST(ColumnsOfABox, HoldItsVolumeAndAtMostTheirRimMore) {
  for (const double yaw : {0.0, 0.3, 0.7854, 1.2}) {
    const Vector3 size(0.12, 0.08, 0.05);
    const Pose X_WP{exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(0.0123, -0.0321, 0.025)};
    double volume = 0.0;
    for (const Column& one : columns_of_box(X_WP, size)) volume += one.top * kColumnSide * kColumnSide;
    EXPECT_GE(volume, size.prod() - 1e-12);
    const double rim = 2.0 * (size.x() + size.y()) * std::sqrt(2.0) * kColumnSide + 8.0 * kColumnSide * kColumnSide;
    EXPECT_LE(volume, size.prod() + rim * size.z());
  }
}

TEST(ColumnsOfABox, FollowItWhenItIsShiftedByWholeColumns) {
  const Vector3 size(0.05, 0.03, 0.04);
  const Pose X_WP{exp_rotation(Vector3(0.3, 0.1, 0.5)), Vector3(0.0011, 0.0007, 0.1)};
  Pose shifted = X_WP;
  shifted.p += Vector3(-40.0 * kColumnSide, 25.0 * kColumnSide, 0.2);
  const std::vector<Column> a = columns_of_box(X_WP, size), b = columns_of_box(shifted, size);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(b[i].x, a[i].x - 40);
    EXPECT_EQ(b[i].y, a[i].y + 25);
    EXPECT_NEAR(b[i].top, a[i].top + 0.2, 1e-9);
  }
}

TEST(ColumnOf, IsTheOneAtOrBelowACoordinateOnBothSidesOfTheOrigin) {
  EXPECT_EQ(column_of(0.0), 0);
  EXPECT_EQ(column_of(0.0049), 0);
  EXPECT_EQ(column_of(0.0051), 1);
  EXPECT_EQ(column_of(-1e-9), -1);
  EXPECT_EQ(column_of(-0.0051), -2);
}

TEST(Bounds, OfOneColumnAreItsSquareAndItsTop) {
  const std::vector<Column> one{{-3, 7, 0.2}};
  const geometry::Aabb bounds = bounds_of(one);
  EXPECT_TRUE(bounds.lower.isApprox(Vector3(-3 * kColumnSide, 7 * kColumnSide, 0.2), 1e-12));
  EXPECT_TRUE(bounds.upper.isApprox(Vector3(-2 * kColumnSide, 8 * kColumnSide, 0.2), 1e-12));
  EXPECT_DEATH((void)bounds_of({}), "an obstacle has columns");
}

/// Random heaps: every column under a box, no box outside of them all, and less waste with more boxes.
TEST(Cover, HasNoMoreThanAskedForAndWastesLessWithMore) {
  Rng rng = Rng(2).split("heaps");
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    std::vector<Column> columns;
    for (int i = 0; i < 4; ++i) {
      const int x = rng.index(20) - 10, y = rng.index(20) - 10, w = 1 + rng.index(8), h = 1 + rng.index(8);
      const double top = rng.uniform(0.02, 0.2);
      for (int row = y; row < y + h; ++row)
        for (int column = x; column < x + w; ++column) {
          if (std::ranges::none_of(columns, [&](const Column& c) { return c.x == column && c.y == row; }))
            columns.push_back({column, row, top});
        }
    }
    const geometry::Aabb around = bounds_of(columns);
    double last = std::numeric_limits<double>::infinity();
    for (int most = 1; most <= 5; ++most) {
      const std::vector<geometry::Aabb> boxes = cover(columns, 0.0, most);
      ASSERT_LE(boxes.size(), static_cast<std::size_t>(most));
      double volume = 0.0;
      for (const geometry::Aabb& box : boxes) {
        volume += (box.upper - box.lower).prod();
        EXPECT_EQ(box.lower.z(), 0.0) << "from the floor";
        EXPECT_GE((box.lower - around.lower).head<2>().minCoeff(), -1e-12);
        EXPECT_LE((box.upper - around.upper).maxCoeff(), 1e-12);
      }
      EXPECT_LE(volume, last + 1e-12);
      last = volume;
      for (const Column& one : columns) {
        const Vector3 p((one.x + 0.5) * kColumnSide, (one.y + 0.5) * kColumnSide, one.top);
        EXPECT_TRUE(std::ranges::any_of(boxes, [&](const geometry::Aabb& box) {
          return (p - box.lower).minCoeff() > -1e-12 && (box.upper - p).minCoeff() > -1e-12;
        }));
      }
    }
  }
}

TEST(Cover, OfColumnsUnderTheFloorHasNoHeight) {
  const std::vector<geometry::Aabb> boxes = cover({{0, 0, -0.1}, {1, 0, -0.2}}, 0.0, 3);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_LE(boxes[0].upper.z(), boxes[0].lower.z()) << "whatever stands there is not in it";
}

}  // namespace
}  // namespace snug::perception
