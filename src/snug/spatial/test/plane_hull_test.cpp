// Plane hull: corners in order, each once.
#include "snug/spatial/plane_hull.hpp"

#include <gtest/gtest.h>

namespace snug {
namespace {

TEST(PlaneHull, HasTheCornersCounterClockwiseAndNeitherInnerNorDoublePoints) {
  const std::vector<Eigen::Vector2d> points = {{1.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {1.0, 0.0},
                                               {0.0, 1.0}, {0.5, 0.0}, {0.0, 0.0}, {1.0, 1.0}};
  std::vector<Eigen::Vector2d> corners;
  for (const std::size_t i : plane_hull(points)) corners.push_back(points[i]);
  EXPECT_EQ(corners, (std::vector<Eigen::Vector2d>{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}));
}

TEST(PlaneHull, OfOnePointAndOfNoneIsItself) {
  EXPECT_TRUE(plane_hull({}).empty());
  const std::vector<Eigen::Vector2d> one = {{2.0, 3.0}};
  EXPECT_EQ(plane_hull(one), std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace snug
