// CameraPerception: what a frame of known boxes tells: seen ones near the truth, covered ones not, empty places as
// such.
#include "snug/perception/camera_perception.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/camera/render.hpp"
#include "snug/core/input_error.hpp"

namespace snug::perception {
namespace {

const Vector3 kSize(0.2, 0.15, 0.1);  ///< m

const model::Scenario& scenario() {
  static const model::Scenario one = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  return one;
}

/// Flat, its middle here over the container's floor.
Pose in_container(double x, double y, double z) {
  const model::Container& container = *model::find_container(scenario(), scenario().target);
  return container.X_WT * Pose{Matrix3::Identity(), Vector3(x, y, z)};
}

std::vector<Expectation> expectations(const std::vector<SceneBox>& boxes) {
  std::vector<Expectation> expected;
  for (const SceneBox& box : boxes) expected.push_back({box.item, box.size, box.X_WP});
  return expected;
}

TEST(CameraPerception, MeasuresBoxesInTheContainerAndStatesItsError) {
  const std::vector<SceneBox> boxes = {{"A", in_container(0.05, 0.15, 0.05), kSize},
                                       {"B", in_container(-0.04, -0.13, 0.05), kSize}};
  const auto camera = make_perception(Kind::Camera, 7, scenario());
  EXPECT_EQ(camera->name(), "camera");
  std::vector<Expectation> expected = expectations(boxes);
  expected[0].X_WP->p += Vector3(0.006, -0.004, 0.003);
  const Observation seen = camera->perceive({1.5, Pose{}, boxes}, expected);
  EXPECT_EQ(seen.time, 1.5);
  EXPECT_TRUE(seen.not_seen.empty());
  EXPECT_TRUE(seen.missing.empty());
  for (const SceneBox& box : boxes) {
    const PoseEstimate* estimate = find(seen, box.item);
    ASSERT_NE(estimate, nullptr) << box.item;
    // docs/camera.md: 95 % within 2.5 mm and 0.7 degrees.
    EXPECT_LT((estimate->X_WP.p - box.X_WP.p).norm(), 0.0035);
    EXPECT_LT(angle_between(estimate->X_WP.R, box.X_WP.R), 0.015);
    EXPECT_FALSE(estimate->size.has_value()) << "sizes are taken as known";
    for (int i = 0; i < 3; ++i) {
      const double sd = std::sqrt(estimate->covariance(i, i));
      EXPECT_GT(sd, 5e-5);
      EXPECT_LT(sd, 5e-3);
      EXPECT_LT(std::abs(estimate->X_WP.p[i] - box.X_WP.p[i]), 4.0 * sd);
    }
  }
}

TEST(CameraPerception, WhatIsCoveredIsNotSeenAndNotMissing) {
  const std::vector<SceneBox> boxes = {{"under", in_container(0.0, 0.0, 0.05), Vector3(0.12, 0.1, 0.1)},
                                       {"over", in_container(0.0, 0.0, 0.15), kSize}};
  const auto seen = make_perception(Kind::Camera, 7, scenario())->perceive({0.0, Pose{}, boxes}, expectations(boxes));
  EXPECT_NE(find(seen, "over"), nullptr);
  EXPECT_EQ(seen.not_seen, (std::vector<std::string>{"under"}));
  EXPECT_TRUE(seen.missing.empty());
}

TEST(CameraPerception, AnEmptyPlaceIsMissingAndAMovedBoxIsFound) {
  const std::vector<SceneBox> boxes = {{"there", in_container(0.05, 0.15, 0.05), kSize}};
  std::vector<Expectation> expected = expectations(boxes);
  expected.push_back({"taken", Vector3(0.1, 0.12, 0.14), in_container(-0.10, -0.10, 0.07)});
  const auto camera = make_perception(Kind::Camera, 7, scenario());
  const Observation seen = camera->perceive({0.0, Pose{}, boxes}, expected);
  EXPECT_EQ(seen.missing, (std::vector<std::string>{"taken"}));
  EXPECT_EQ(seen.not_seen, seen.missing);
  expected = {expected[0]};
  expected[0].X_WP = in_container(-0.05, -0.15, 0.05);
  const Observation moved = camera->perceive({0.0, Pose{}, boxes}, expected);
  const PoseEstimate* found = find(moved, "there");
  ASSERT_NE(found, nullptr);
  EXPECT_LT((found->X_WP.p - boxes[0].X_WP.p).norm(), 0.005);
}

TEST(CameraPerception, ReportsAForeignObjectWithItsHeightsAndForgetsNothingByItself) {
  const std::vector<SceneBox> boxes = {{"A", in_container(0.05, 0.15, 0.05), kSize}};
  const Vector3 size(0.09, 0.07, 0.06);
  const SceneBox object{"stranger", in_container(-0.05, -0.12, 0.03), size};
  const auto camera = make_perception(Kind::Camera, 7, scenario());
  const Observation with = camera->perceive({0.0, Pose{}, boxes, {object}}, expectations(boxes));
  ASSERT_TRUE(with.obstacles);
  ASSERT_EQ(with.obstacles->size(), 1U);
  const Obstacle& one = with.obstacles->front();
  EXPECT_GT(one.deviation, 1e-4);
  EXPECT_LT(one.deviation, 2e-3);
  const geometry::Aabb seen = bounds_of(one.columns);
  const Vector3 low = object.X_WP.p - 0.5 * size, high = object.X_WP.p + 0.5 * size;
  EXPECT_NEAR(seen.upper.z(), high.z(), 0.002);
  for (int axis = 0; axis < 2; ++axis) {  // whole columns; edges lose a few points
    EXPECT_NEAR(seen.lower[axis], low[axis], kColumnSide + 0.002);
    EXPECT_NEAR(seen.upper[axis], high[axis], kColumnSide + 0.002);
  }
  ASSERT_TRUE(with.heights);
  const int x = column_of(object.X_WP.p.x()), y = column_of(object.X_WP.p.y());
  EXPECT_NEAR(with.heights->at(x, y).value_or(9.0), high.z(), 0.002);
  const Observation without = camera->perceive({0.0, Pose{}, boxes, {}}, expectations(boxes));
  EXPECT_TRUE(without.obstacles->empty());
  EXPECT_NEAR(without.heights->at(x, y).value_or(9.0), in_container(0.0, 0.0, 0.0).p.z(), 0.003);
}

TEST(CameraPerception, SaysThatAPictureTellsNothingAndWhy) {
  const std::vector<SceneBox> boxes = {{"A", in_container(0.05, 0.15, 0.05), kSize}};
  const SceneBox arm{"arm", in_container(0.0, 0.1, 0.6), Vector3(0.4, 0.3, 0.1)};
  const auto camera = make_perception(Kind::Camera, 7, scenario());
  const Observation blocked = camera->perceive({0.0, Pose{}, boxes, {arm}}, expectations(boxes));
  EXPECT_EQ(blocked.fault, LookFault::ViewBlocked);
  model::Scenario dirty_cell = scenario();
  dirty_cell.cameras.front().errors.loss.random = 0.7;
  const Observation dirty =
      make_perception(Kind::Camera, 7, dirty_cell)->perceive({0.0, Pose{}, boxes}, expectations(boxes));
  EXPECT_EQ(dirty.fault, LookFault::TooFewPoints);
  for (const Observation& one : {blocked, dirty}) {
    EXPECT_FALSE(one.obstacles) << "neither there nor gone";
    EXPECT_TRUE(one.missing.empty());
    EXPECT_EQ(one.not_seen, (std::vector<std::string>{"A"}));
  }
  EXPECT_EQ(camera->perceive({0.0, Pose{}, boxes}, expectations(boxes)).fault, LookFault::None);
}

TEST(CameraPerception, StationsMeasureOutsideTheContainerWithSize) {
  const std::vector<SceneBox> boxes = {{"new", scenario().aligner->X_WA, kSize}};
  const auto camera = make_perception(Kind::Camera, 7, scenario());
  double worst = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Observation seen = camera->perceive({0.0, Pose{}, boxes}, {});
    ASSERT_EQ(seen.seen.size(), 1U);
    ASSERT_TRUE(seen.seen[0].size.has_value());
    EXPECT_LE((*seen.seen[0].size - kSize).cwiseAbs().maxCoeff(), kStationNoise.size);
    worst = std::max(worst, (seen.seen[0].X_WP.p - boxes[0].X_WP.p).cwiseAbs().maxCoeff());
  }
  EXPECT_LE(worst, kStationNoise.position);
  EXPECT_GT(worst, 0.5 * kStationNoise.position);
}

TEST(CameraPerception, TheSameSeedSeesTheSame) {
  const std::vector<SceneBox> boxes = {{"A", in_container(0.05, 0.15, 0.05), kSize}};
  const auto look = [&](std::uint64_t seed) {
    const auto camera = make_perception(Kind::Camera, seed, scenario());
    (void)camera->perceive({0.0, Pose{}, boxes}, expectations(boxes));
    return camera->perceive({0.0, Pose{}, boxes}, expectations(boxes));
  };
  EXPECT_EQ(look(7), look(7));
  EXPECT_NE(look(7).seen[0].X_WP, look(8).seen[0].X_WP);
}

TEST(CameraPerception, NeedsACamera) {
  model::Scenario blind = scenario();
  blind.cameras.clear();
  EXPECT_THROW((void)make_perception(Kind::Camera, 1, blind), InputError);
  EXPECT_EQ(make_perception(Kind::Exact, 1, blind)->name(), "exact");
}

TEST(CameraPerception, TheToolInAFrameIsNoObstacleAndWhatStandsElsewhereIs) {
  const std::vector<SceneBox> boxes = {{"A", in_container(0.05, 0.15, 0.05), kSize}};
  const Vector3 size(0.06, 0.06, 0.2);
  const SceneBox tool{"tool", in_container(-0.05, -0.12, 0.3), size};
  const SceneBox stranger{"stranger", in_container(0.12, -0.05, 0.03), Vector3(0.06, 0.05, 0.06)};
  const camera::FrameSource source = [&](std::uint64_t look, double) -> Expected<camera::Frame, std::string> {
    camera::Scene view = camera::make_surroundings(scenario());
    for (const SceneBox* one : {&boxes.front(), &tool, &stranger})
      camera::add_box(view, one->item, one->X_WP, one->size);
    const model::CameraParams& params = scenario().cameras.front();
    return camera::render(view, params, camera::draw_camera(params, 7), look).frame;
  };
  const auto look_with_tool_at = [&](const Vector3& p) {
    const Pose X_WE{exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0)), p};
    return make_perception(Kind::Frames, 7, scenario(), source)->perceive({0.0, X_WE, boxes}, expectations(boxes));
  };
  const double low = tool.X_WP.p.z() - 0.5 * size.z() - 0.01;
  const auto count_high = [&](const Observation& look) {
    return std::ranges::count_if(look.heights->height, [&](float z) { return z > low; });
  };
  const Observation known = look_with_tool_at(tool.X_WP.p);
  ASSERT_EQ(known.obstacles->size(), 1U);
  EXPECT_LT(bounds_of(known.obstacles->front().columns).upper.z(), in_container(0.0, 0.0, 0.07).p.z());
  const Observation elsewhere = look_with_tool_at(tool.X_WP.p + Vector3(0.0, 0.0, 1.0));
  EXPECT_EQ(elsewhere.obstacles->size(), 2U);
  EXPECT_LT(count_high(known), count_high(elsewhere));
}

}  // namespace
}  // namespace snug::perception
