// Edges of depth, corners, distances to them, and what is lost near them.
#include "snug/camera/internal/edges.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "snug/camera/loss.hpp"
#include "snug/core/rng.hpp"

namespace snug::camera::internal {
namespace {

CastView view_of(int rows = 100, int cols = 140) {
  CastView view;
  view.optics = {200.0, 200.0, 0.5 * cols - 0.5, 0.5 * rows - 0.5};
  view.rows = rows;
  view.cols = cols;
  return view;
}

int count(const Grid2<std::uint8_t>& borders, int bits) {
  int all = 0;
  for (const std::uint8_t border : borders.values()) all += (border & bits) != 0 ? 1 : 0;
  return all;
}

TEST(FindBorders, APlaneHasNone) {
  Scene scene;
  add_box(scene, "wall", {exp_rotation(Vector3(0.3, 0.2, 0)), Vector3(0, 0, 1.0)}, Vector3(9, 9, 0.1));
  EXPECT_EQ(count(find_borders(cast(scene, view_of()), 1), 0xff), 0);
}

/// Two walls side by side, one `step` nearer: an edge of depth beyond 2.5 mm, nothing below.
TEST(FindBorders, AStepIsAnEdgeOfDepthFromTwoAndAHalfMillimetresOn) {
  for (const double step : {0.0, 0.0020, 0.0030, 0.1}) {
    SCOPED_TRACE(step);
    Scene scene;
    add_box(scene, "left", {Matrix3::Identity(), Vector3(-2.0, 0, 1.0)}, Vector3(4.0, 9, 0.1));
    add_box(scene, "right", {Matrix3::Identity(), Vector3(2.0, 0, 1.0 - step)}, Vector3(4.0, 9, 0.1));
    const CastView view = view_of();
    const Grid2<std::uint8_t> borders = find_borders(cast(scene, view), 1);
    EXPECT_EQ(count(borders, kJumpRight), step > 0.0025 ? view.rows : 0);
    EXPECT_EQ(count(borders, kJumpBelow), 0);
  }
}

/// Two slabs whose front faces meet at 1 m, each turned by `lean` about the line where they meet: below 0 a valley.
Grid2<std::uint8_t> borders_of_fold(double lean) {
  Scene scene;
  for (const double side : {-1.0, 1.0}) {
    add_box(scene, side < 0.0 ? "left" : "right",
            Pose{exp_rotation(Vector3(0, -side * lean, 0)), Vector3(0, 0, 1.0)} *
                Pose{Matrix3::Identity(), Vector3(2.0 * side, 0, 0.05)},
            Vector3(4, 9, 0.1));
  }
  return find_borders(cast(scene, view_of()), 1);
}

/// A pixel is 1 m / 200 = 5 mm wide. One pixel beyond the fold the planes are 2 tan(lean) 2.5 mm apart: 1.5 mm at
/// 0.3 rad, no edge of depth.
TEST(FindBorders, ACornerIsWhereSurfacesLookAtEachOther) {
  const Grid2<std::uint8_t> valley = borders_of_fold(-0.3), ridge = borders_of_fold(0.3);
  EXPECT_EQ(count(valley, kCornerRight), valley.rows());
  EXPECT_EQ(count(ridge, kCornerRight), 0);
  EXPECT_EQ(count(valley, kJumpRight) + count(ridge, kJumpRight), 0) << "they meet";
}

/// 3.4 mm at 0.6 rad, beyond kEdgeOfDepth: pixels of this width do not tell a ridge from an edge.
TEST(FindBorders, ARidgeTooSteepForItsPixelsIsAnEdgeOfDepth) {
  const Grid2<std::uint8_t> ridge = borders_of_fold(0.6);
  EXPECT_EQ(count(ridge, kJumpRight), ridge.rows());
}

TEST(FindBorders, WhereNothingIsSeenBehindIsAnEdge) {
  Scene scene;
  add_box(scene, "box", {Matrix3::Identity(), Vector3(0, 0, 1.0)}, Vector3(0.2, 0.2, 0.1));
  const Grid2<std::uint8_t> borders = find_borders(cast(scene, view_of()), 1);
  const int side = static_cast<int>(std::lround(0.2 * 200.0 / 0.95));
  EXPECT_NEAR(count(borders, kJumpRight), 2 * side, 4);
  EXPECT_NEAR(count(borders, kJumpBelow), 2 * side, 4);
}

/// The slow way: along the row and along the column of each pixel.
int slow_distance(const Grid2<std::uint8_t>& borders, int row, int col, int most) {
  int best = most + 1;
  for (int c = 0; c + 1 < borders.cols(); ++c)
    if ((borders(row, c) & kJumpRight) != 0) best = std::min(best, c < col ? col - c : c - col + 1);
  for (int r = 0; r + 1 < borders.rows(); ++r)
    if ((borders(r, col) & kJumpBelow) != 0) best = std::min(best, r < row ? row - r : r - row + 1);
  return best;
}

TEST(EdgeDistance, IsThatOfTheSlowWayOnRandomBordersAtAnyNumberOfThreads) {
  Rng rng = Rng(2).split("borders");
  for (int i = 0; i < 5; ++i) {
    Grid2<std::uint8_t> borders(90, 70);
    for (std::uint8_t& border : borders.values()) {
      border = rng.uniform() < 0.01 ? static_cast<std::uint8_t>(1 + rng.index(3)) : std::uint8_t{0};
    }
    for (int r = 0; r < 90; ++r) borders(r, 69) = static_cast<std::uint8_t>(borders(r, 69) & ~kJumpRight);
    for (int c = 0; c < 70; ++c) borders(89, c) = static_cast<std::uint8_t>(borders(89, c) & ~kJumpBelow);
    const Grid2<std::uint8_t> distance = edge_distance(borders, 9, 1);
    for (int r = 0; r < 90; ++r)
      for (int c = 0; c < 70; ++c) ASSERT_EQ(distance(r, c), slow_distance(borders, r, c, 9)) << r << " " << c;
    EXPECT_EQ(distance, edge_distance(borders, 9, 3));
    EXPECT_EQ(corner_distance(borders, 9, 1), corner_distance(borders, 9, 3));
  }
}

TEST(CornerDistance, GoesAlongRowsThenColumnsAndNotAcrossAnEdge) {
  Grid2<std::uint8_t> borders(1, 20);
  borders(0, 9) = kCornerRight;  // between 9 and 10
  Grid2<std::uint8_t> distance = corner_distance(borders, 5, 1);
  for (int c = 0; c < 20; ++c) EXPECT_EQ(distance(0, c), std::min(6, c <= 9 ? 10 - c : c - 9)) << c;
  borders(0, 12) = kJumpRight;
  distance = corner_distance(borders, 5, 1);
  EXPECT_EQ(distance(0, 12), 3);
  EXPECT_EQ(distance(0, 13), 6) << "behind the edge there is no corner near";
}

TEST(EdgeLoss, FallsOffLikeAGaussianAndEndsBelowHalfAPercent) {
  model::PointLoss loss;
  loss.edge = 0.8;
  loss.edge_width = 3.0;
  const std::vector<float> lost = edge_loss(loss);
  ASSERT_FALSE(lost.empty());
  for (std::size_t d = 0; d < lost.size(); ++d) {
    const double x = (static_cast<double>(d) + 0.5) / 3.0;
    EXPECT_NEAR(lost[d], 0.8 * std::exp(-x * x), 1e-6);
    EXPECT_GE(lost[d], 0.005F);
  }
  const double next = (static_cast<double>(lost.size()) + 0.5) / 3.0;
  EXPECT_LT(0.8 * std::exp(-next * next), 0.005);
  loss.edge = 0.0;
  EXPECT_TRUE(edge_loss(loss).empty());
}

TEST(EdgeLossAtRidge, IsWholeWithoutAFaceBehindAndNoneOnFlatOnes) {
  EXPECT_EQ(edge_loss_at_ridge(0.0, 1e-3), 1.0);
  EXPECT_EQ(edge_loss_at_ridge(10.0, 1e-3), 0.0);
  double before = 1.0;
  for (double ridge = 0.01; ridge < 0.5; ridge += 0.01) {
    const double now = edge_loss_at_ridge(ridge, 1e-3);
    EXPECT_LE(now, before);
    before = now;
  }
  // Half of the places where twice the edge's depth, times the ridge, is half a pixel.
  EXPECT_NEAR(edge_loss_at_ridge(0.25 * 1e-3 / kEdgeOfDepth, 1e-3), 0.5, 1e-12);
}

TEST(GrazingLoss, IsLinearInTheCosineBetweenOnsetAndFull) {
  model::PointLoss loss;
  loss.grazing_onset = 1.0;
  loss.grazing_full = 1.4;
  const GrazingLoss grazing(loss);
  EXPECT_EQ(grazing(1.0F), 0.0F);
  EXPECT_EQ(grazing(static_cast<float>(std::cos(0.99))), 0.0F);
  EXPECT_EQ(grazing(static_cast<float>(std::cos(1.41))), 1.0F);
  EXPECT_NEAR(grazing(static_cast<float>(0.5 * (std::cos(1.0) + std::cos(1.4)))), 0.5F, 1e-5F);
}

}  // namespace
}  // namespace snug::camera::internal
