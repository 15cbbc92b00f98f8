// Height maps and regions: against the slow way, at borders, and without a region.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "snug/box_estimation/internal/obstacles.hpp"
#include "snug/box_estimation/internal/search.hpp"
#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

EstimateInput region_of(const FitScene& scene) {
  return make_input(scene.cell.scenario, scene.cell.scenario.containers.front());
}

TEST(HeightMap, IsTheHighestPointOfEachCellTheSlowWay) {
  const FitScene scene(three_boxes(), "structured_light", 4);
  const EstimateInput input = region_of(scene);
  const HeightMap map = make_height_map(scene.context(), input);
  std::map<std::pair<int, int>, double> highest;  // by column of x and y, counted from the origin of W
  for (int r = 0; r < scene.frame.depth.rows(); ++r)
    for (int c = 0; c < scene.frame.depth.cols(); ++c) {
      const double depth = scene.frame.depth(r, c);
      if (depth == 0.0) continue;
      const Vector3 p = scene.frame.camera.X_WC * (depth * camera::pixel_ray(scene.frame.camera.intrinsics, c, r));
      if ((p.array() < input.region_low.array()).any() || (p.array() > input.region_high.array()).any()) continue;
      const std::pair<int, int> at{static_cast<int>(std::floor(p.x() / map.cell)),
                                   static_cast<int>(std::floor(p.y() / map.cell))};
      const auto [found, is_new] = highest.try_emplace(at, p.z());
      if (!is_new) found->second = std::max(found->second, p.z());
    }
  int seen = 0;
  for (int row = 0; row < map.height.rows(); ++row)
    for (int col = 0; col < map.height.cols(); ++col) {
      const double x = map.origin.x() + (col + 0.5) * map.cell, y = map.origin.y() + (row + 0.5) * map.cell;
      const auto found =
          highest.find({static_cast<int>(std::floor(x / map.cell)), static_cast<int>(std::floor(y / map.cell))});
      ASSERT_EQ(found == highest.end(), std::isnan(map.height(row, col))) << row << " " << col;
      if (found == highest.end()) continue;
      EXPECT_NEAR(map.height(row, col), found->second, 1e-6);
      ++seen;
    }
  EXPECT_EQ(seen, static_cast<int>(highest.size()));
  EXPECT_GT(seen, 5000) << "0.4 m x 0.6 m in cells of 5 mm: 9600, some behind boxes";
}

TEST(HeightMap, HasWholeCellsFromTheOriginOfTheWorldAndHoldsTheRegion) {
  const FitScene scene({});
  EstimateInput input = region_of(scene);
  input.region_low.x() = -0.1234;
  input.region_high.y() = 0.2111;
  const HeightMap map = make_height_map(scene.context(), input);
  for (int k = 0; k < 2; ++k) {
    const double cells = map.origin(k) / map.cell;
    EXPECT_NEAR(cells, std::round(cells), 1e-9);
    EXPECT_LE(map.origin(k), input.region_low(k));
    EXPECT_GT(map.origin(k) + map.cell, input.region_low(k));
  }
  EXPECT_GE(map.origin.y() + map.height.rows() * map.cell, input.region_high.y());
  EXPECT_GE(map.origin.x() + map.height.cols() * map.cell, input.region_high.x());
}

TEST(HeightMap, OfNoRegionOrNoPointIsEmpty) {
  FitScene scene(three_boxes());
  EstimateInput anywhere = region_of(scene);
  anywhere.region_low = Vector3::Constant(-1e3);
  anywhere.region_high = Vector3::Constant(1e3);
  EXPECT_EQ(make_height_map(scene.context(), anywhere).height.rows(), 0);
  for (float& depth : scene.frame.depth.values()) depth = 0.0F;
  const HeightMap blind = make_height_map(scene.context(), region_of(scene));
  ASSERT_GT(blind.height.rows(), 0);
  for (const float height : blind.height.values()) EXPECT_TRUE(std::isnan(height));
}

TEST(Region, OfAContainerIsItsInsideHoweverItStands) {
  Cell cell;
  const EstimateInput level_one = make_input(cell.scenario, cell.scenario.containers.front());
  EXPECT_LT((level_one.region_low - Vector3(-0.2, -0.3, 0.0)).norm(), 1e-12);
  EXPECT_LT((level_one.region_high - Vector3(0.2, 0.3, 0.25)).norm(), 1e-12);
  EXPECT_TRUE(level_one.boxes.empty());
  model::Container turned = cell.scenario.containers.front();
  turned.X_WT = {exp_rotation(Vector3(0.0, 0.0, 0.25 * 3.14159265358979323846)), Vector3(1.0, 2.0, 0.5)};
  const EstimateInput diagonal = make_input(cell.scenario, turned);
  // Turned by 45 degrees a floor of a x b spans (a + b) / sqrt 2 along both axes.
  const double half = 0.5 * (0.4 + 0.6) / std::sqrt(2.0);
  EXPECT_LT((diagonal.region_low - Vector3(1.0 - half, 2.0 - half, 0.5)).norm(), 1e-12);
  EXPECT_LT((diagonal.region_high - Vector3(1.0 + half, 2.0 + half, 0.75)).norm(), 1e-12);
}

TEST(Unexplained, IsWhatStandsBeforeThePredictionByMoreThanTheTolerance) {
  const FitScene scene({{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.10, 0.05, 0.3)}});
  const auto count = [&](const std::vector<TrackedBox>& boxes, double tolerance) {
    int sum = 0;
    const camera::Grid2<std::uint8_t> mask = unexplained(scene.frame, scene.predict(boxes), tolerance);
    for (const std::uint8_t one : mask.values()) sum += one;
    return sum;
  };
  const Box box{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.10, 0.05, 0.3)};
  const int without = count({}, 1e-3);
  EXPECT_GT(without, 10'000);
  EXPECT_EQ(count({scene.tracked(box)}, 1e-3), 0);
  // What is predicted higher than it is is not unexplained: nothing stands before it, but its sides' feet.
  EXPECT_LT(count({scene.tracked(box, Vector3(0, 0, -0.01))}, 1e-3), without / 20);
  EXPECT_GT(count({scene.tracked(box, Vector3(0, 0, 0.01))}, 1e-3), without / 2);
  EXPECT_LE(count({}, 0.05), without) << "less than half of it stands higher than that";
  EXPECT_EQ(count({}, 0.2), 0);
}

TEST(FindObstacles, AskForNoOrderOfWhatStandsThere) {
  const std::vector<Box> things = {{"a", Vector3(0.05, 0.06, 0.03), level(0.10, 0.20, 0.015)},
                                   {"b", Vector3(0.16, 0.10, 0.12), level(-0.05, -0.15, 0.06)}};
  const auto found = [](const std::vector<Box>& boxes) {
    const FitScene scene(boxes);
    return find_obstacles(scene.context(), region_of(scene), unexplained(scene.frame, scene.predict({}), 2e-3));
  };
  const std::vector<Obstacle> a = found(things), b = found({things[1], things[0]});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].low, b[i].low);
    EXPECT_EQ(a[i].high, b[i].high);
    EXPECT_EQ(a[i].points, b[i].points);
    EXPECT_EQ(a[i].columns.size(), b[i].columns.size());
  }
}

TEST(FindObstacles, HaveColumnsWhoseTopsAreTheirHighestPoints) {
  const FitScene scene({{"b", Vector3(0.16, 0.10, 0.12), level(-0.05, -0.15, 0.06, 0.4)}});
  const std::vector<Obstacle> obstacles =
      find_obstacles(scene.context(), region_of(scene), unexplained(scene.frame, scene.predict({}), 2e-3));
  ASSERT_EQ(obstacles.size(), 1U);
  double top = -1.0;
  for (const geometry::Column& column : obstacles[0].columns) {
    top = std::max(top, column.top);
    EXPECT_GE((column.x + 1) * geometry::kColumnSide, obstacles[0].low.x());
    EXPECT_LE(column.x * geometry::kColumnSide, obstacles[0].high.x());
    EXPECT_GE((column.y + 1) * geometry::kColumnSide, obstacles[0].low.y());
    EXPECT_LE(column.y * geometry::kColumnSide, obstacles[0].high.y());
  }
  EXPECT_EQ(top, obstacles[0].high.z());
}

}  // namespace
}  // namespace snug::box_estimation::internal
