// Obstacles and height maps: what is left of a frame, and how high everything stands.
#include "snug/box_estimation/internal/obstacles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/box_estimation/internal/search.hpp"
#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

EstimateInput input_of(const FitScene& scene) {
  return make_input(scene.cell.scenario, scene.cell.scenario.containers.front());
}

std::vector<Obstacle> obstacles_of(const FitScene& scene) {
  return find_obstacles(scene.context(), input_of(scene), unexplained(scene.frame, scene.predict({}), 2e-3));
}

TEST(FindObstacles, AnEmptyContainerHasNone) { EXPECT_TRUE(obstacles_of(FitScene({})).empty()); }

TEST(FindObstacles, EachIsAsLargeAndAsHighAsItIsLargestFirst) {
  const FitScene scene({{"small", Vector3(0.05, 0.06, 0.03), level(0.10, 0.20, 0.015)},
                        {"large", Vector3(0.16, 0.10, 0.12), level(-0.05, -0.15, 0.06)}});
  const std::vector<Obstacle> obstacles = obstacles_of(scene);
  ASSERT_EQ(obstacles.size(), 2u);
  EXPECT_GT(obstacles[0].points, obstacles[1].points);
  EXPECT_NEAR(obstacles[0].high.z(), 0.12, 1e-3);
  EXPECT_NEAR(obstacles[1].high.z(), 0.03, 1e-3);
  const double pixel = 0.97 / scene.frame.camera.intrinsics.fx;
  EXPECT_NEAR(obstacles[1].low.x(), 0.075, 4.0 * pixel) << "a cell of four pixels";
  EXPECT_NEAR(obstacles[1].high.x(), 0.125, 4.0 * pixel);
  EXPECT_NEAR(obstacles[1].low.y(), 0.17, 4.0 * pixel);
  EXPECT_NEAR(obstacles[1].high.y(), 0.23, 4.0 * pixel);
  for (const Obstacle& one : obstacles) {
    EXPECT_FALSE(one.columns.empty());
    for (const geometry::Column& column : one.columns) EXPECT_LE(column.top, one.high.z());
  }
  // Columns of 5 mm: as many as the top has, and those that its rim touches.
  const double columns = 0.05 * 0.06 / (geometry::kColumnSide * geometry::kColumnSide);
  EXPECT_GT(static_cast<double>(obstacles[1].columns.size()), 0.8 * columns);
  EXPECT_LT(static_cast<double>(obstacles[1].columns.size()), 1.6 * columns);
}

TEST(FindObstacles, WhatHasFewPointsIsNone) {
  FitScene scene({{"small", Vector3(0.05, 0.06, 0.03), level(0.10, 0.20, 0.015)}});
  ASSERT_EQ(obstacles_of(scene).size(), 1u);
  const int points = obstacles_of(scene).front().points;
  scene.settings.obstacles.least_points = points + 1;
  EXPECT_TRUE(obstacles_of(scene).empty());
  scene.settings.obstacles.least_points = points;
  EXPECT_EQ(obstacles_of(scene).size(), 1u);
}

TEST(FindObstacles, WhatLiesOutsideTheRegionIsPassedOver) {
  const FitScene scene({{"beside", Vector3(0.10, 0.10, 0.20), level(0.32, 0.0, 0.10)}});
  EXPECT_TRUE(obstacles_of(scene).empty());
}

TEST(FindObstacles, WhatStandsOutOverTheRimIsInTheWay) {
  const FitScene scene({{"pole", Vector3(0.06, 0.06, 0.40), level(0.0, 0.0, 0.20)}});
  const std::vector<Obstacle> obstacles = obstacles_of(scene);
  ASSERT_EQ(obstacles.size(), 1u);
  EXPECT_NEAR(obstacles[0].high.z(), 0.40, 1e-3) << "the container is 0.25 m high";
}

TEST(HeightMap, IsTheHighestPointOverEachCell) {
  const FitScene scene({{"box", Vector3(0.16, 0.10, 0.12), level(-0.05, -0.15, 0.06)}});
  const HeightMap map = make_height_map(scene.context(), input_of(scene));
  const auto height = [&map](double x, double y) {
    return map.height(static_cast<int>(std::floor((y - map.origin.y()) / map.cell)),
                      static_cast<int>(std::floor((x - map.origin.x()) / map.cell)));
  };
  for (double x = -0.10; x < 0.0; x += 0.02) EXPECT_NEAR(height(x, -0.15), 0.12, 1e-4);
  for (double x = -0.18; x < 0.18; x += 0.02) EXPECT_NEAR(height(x, 0.20), 0.0, 1e-4);
  EXPECT_GE(map.height.rows() * map.cell, 0.6);
  EXPECT_GE(map.height.cols() * map.cell, 0.4);
  EXPECT_LE(map.origin.x(), -0.2);
}

TEST(HeightMap, HasNoHeightWhereNothingWasSeenAndNoCellsWithoutARegion) {
  FitScene scene({});
  for (float& depth : scene.frame.depth.values()) depth = 0.0F;
  const HeightMap map = make_height_map(scene.context(), input_of(scene));
  ASSERT_GT(map.height.values().size(), 0u);
  for (const float height : map.height.values()) EXPECT_TRUE(std::isnan(height));
  EstimateInput everywhere;  // 2 km a side
  EXPECT_EQ(make_height_map(scene.context(), everywhere).height.values().size(), 0u);
}

}  // namespace
}  // namespace snug::box_estimation::internal
