// Obstacle: columns of boxes, and covers that hold every column and little else.
#include "snug/perception/obstacle.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace snug::perception {
namespace {

std::vector<Column> block(int x1, int y1, int x2, int y2, double top) {
  std::vector<Column> columns;
  for (int y = y1; y < y2; ++y)
    for (int x = x1; x < x2; ++x) columns.push_back({x, y, top});
  return columns;
}

bool is_covered(const Column& one, const std::vector<geometry::Aabb>& boxes) {
  for (const geometry::Aabb& box : boxes) {
    const double x = (one.x + 0.5) * kColumnSide, y = (one.y + 0.5) * kColumnSide;
    if (x > box.lower.x() && x < box.upper.x() && y > box.lower.y() && y < box.upper.y() && one.top <= box.upper.z())
      return true;
  }
  return false;
}

TEST(Obstacle, ColumnsOfALevelBoxAreItsFootprintAndItsTop) {
  const std::vector<Column> columns =
      columns_of_box({Matrix3::Identity(), {0.0525, 0.1025, 0.03}}, {0.0548, 0.0246, 0.06});
  EXPECT_EQ(columns.size(), 11U * 5U);
  for (const Column& one : columns) EXPECT_NEAR(one.top, 0.06, 1e-12);
  const geometry::Aabb bounds = bounds_of(columns);
  EXPECT_NEAR(bounds.lower.x(), 0.025, 1e-12);
  EXPECT_NEAR(bounds.upper.y(), 0.115, 1e-12);
}

TEST(Obstacle, ColumnsOfATiltedBoxFollowItsUpperFaces) {
  const double angle = 0.3;
  const std::vector<Column> columns =
      columns_of_box({exp_rotation(Vector3(0.0, angle, 0.0)), {0.0, 0.0, 0.1}}, {0.1, 0.1, 0.04});
  double highest = 0.0;
  for (const Column& one : columns) highest = std::max(highest, one.top);
  // Of a turned rectangle: half the diagonals' heights. Columns reach at most half a column short of the corner.
  const double corner = 0.1 + 0.05 * std::sin(angle) + 0.02 * std::cos(angle);
  EXPECT_LE(highest, corner + 1e-12);
  EXPECT_GT(highest, corner - 0.5 * kColumnSide * std::tan(1.5707963 - angle));
  EXPECT_LT(columns.back().top, 0.17);
}

TEST(Obstacle, OneBoxCoversABlockAndTwoAnL) {
  EXPECT_EQ(cover(block(3, 4, 13, 10, 0.05), 0.0, 4).size(), 1U);
  std::vector<Column> l = block(0, 0, 20, 5, 0.05);
  const std::vector<Column> leg = block(0, 5, 5, 20, 0.05);
  l.insert(l.end(), leg.begin(), leg.end());
  const auto boxes = cover(l, 0.0, 4);
  ASSERT_EQ(boxes.size(), 2U);
  double volume = 0.0;
  for (const geometry::Aabb& box : boxes) volume += (box.upper - box.lower).prod();
  EXPECT_NEAR(volume, static_cast<double>(l.size()) * kColumnSide * kColumnSide * 0.05, 1e-12);
  EXPECT_EQ(cover(l, 0.0, 1).size(), 1U) << "no more than asked for";
}

TEST(Obstacle, ALowPartBesideAHighOneHasABoxOfItsOwn) {
  std::vector<Column> columns = block(0, 0, 10, 10, 0.03);
  const std::vector<Column> high = block(10, 0, 14, 10, 0.12);
  columns.insert(columns.end(), high.begin(), high.end());
  const auto boxes = cover(columns, 0.0, 4);
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_NEAR(std::min(boxes[0].upper.z(), boxes[1].upper.z()), 0.03, 1e-12);
}

TEST(Obstacle, CoversHoldEveryColumnOfAnyShape) {
  for (int k = 1; k <= 20; ++k) {
    std::vector<Column> columns;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 15; ++x)
        if ((x * k + y * y) % 3 != 0) columns.push_back({x - 7, y - 5, 0.01 + 0.002 * ((x * y + k) % 11)});
    const auto boxes = cover(columns, 0.0, 6);
    EXPECT_LE(boxes.size(), 6U);
    for (const Column& one : columns) EXPECT_TRUE(is_covered(one, boxes)) << k;
  }
  EXPECT_TRUE(cover({}, 0.0, 4).empty());
}

TEST(Obstacle, AHeightMapTellsNothingWhereNothingWasSeen) {
  const HeightMap map{-2, 3, 2, 2, {0.1F, HeightMap::kUnseen, 0.3F, 0.4F}};
  EXPECT_NEAR(*map.at(-2, 3), 0.1, 1e-6);
  EXPECT_FALSE(map.at(-1, 3));
  EXPECT_NEAR(*map.at(-1, 4), 0.4, 1e-6);
  EXPECT_FALSE(map.at(0, 3));
  EXPECT_FALSE(map.at(-2, 5));
}

}  // namespace
}  // namespace snug::perception
