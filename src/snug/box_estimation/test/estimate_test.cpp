// estimate_boxes: on scenes whose truth is known by construction.
#include "snug/box_estimation/estimate.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "snug/box_estimation/internal/joint_fit.hpp"
#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation {
namespace {

using namespace test;

TEST(EstimateBoxes, FindsBoxesInAPerfectFrameToATenthOfAMillimetre) {
  const Cell cell("ideal");
  const std::vector<Box> boxes = three_boxes();
  const Estimate estimate = estimate_boxes(frame_of(cell, boxes, 1), expect(cell, boxes, 1));
  ASSERT_EQ(estimate.fault, FrameFault::None);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    SCOPED_TRACE(boxes[i].id);
    EXPECT_EQ(estimate.boxes[i].sight, Sight::Seen);
    // Along the optical axis rounding alone; across it the grid of pixels, 1 mm, evened out along edges of a hundred.
    EXPECT_NEAR(estimate.boxes[i].X_WP.p.z(), boxes[i].X_WP.p.z(), 0.1e-3);
    EXPECT_LT((estimate.boxes[i].X_WP.p - boxes[i].X_WP.p).norm(), 0.4e-3);
    EXPECT_LT(angle_between(estimate.boxes[i].X_WP.R, boxes[i].X_WP.R), 0.004);
  }
  EXPECT_TRUE(estimate.obstacles.empty());
}

TEST(EstimateBoxes, ErrorsAreAsLargeAsTheirCovarianceSays) {
  const Cell cell;
  const std::vector<Box> boxes = three_boxes();
  double sum = 0.0, product = 0.0, stated = 0.0;
  constexpr int kFrames = 40;
  for (std::uint64_t seed = 1; seed <= kFrames; ++seed) {
    const Estimate estimate = estimate_boxes(frame_of(cell, boxes, seed), expect(cell, boxes, seed));
    const BoxEstimate &a = estimate.boxes[0], &b = estimate.boxes[1];
    product += (a.X_WP.p - boxes[0].X_WP.p).dot(b.X_WP.p - boxes[1].X_WP.p);
    stated += (a.common * b.common.transpose()).topLeftCorner<3, 3>().trace();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const BoxEstimate& box = estimate.boxes[i];
      ASSERT_EQ(box.sight, Sight::Seen) << seed;
      Vector6 off;
      off << box.X_WP.p - boxes[i].X_WP.p, log_rotation(box.X_WP.R * boxes[i].X_WP.R.transpose());
      EXPECT_LT(off.head<3>().norm(), 3e-3);
      sum += off.dot(box.covariance.ldlt().solve(off)) / (6.0 * kFrames * static_cast<double>(boxes.size()));
    }
  }
  // One value of six degrees for each camera (its boxes share its errors): 40 of them, four standard errors.
  EXPECT_NEAR(sum, 1.0, 4.0 * std::sqrt(2.0 / (6.0 * kFrames)));
  // What two boxes have in common. Of a product of normals with correlation r the relative variance is 1 + 1/r^2, of
  // three axes a third; r is 0.8 here.
  EXPECT_NEAR(product / stated, 1.0, 4.0 * std::sqrt((1.0 + 1.0 / (0.8 * 0.8)) / (3.0 * kFrames)));
}

/// Boxes side by side, as high as each other: between them no edge, and of their sides no more than a strip is seen.
/// None is off by so much that it would count as moved.
TEST(EstimateBoxes, TellsNeighboursOfOneHeightApart) {
  const Cell cell;
  std::vector<Box> boxes;
  for (int i = 0; i < 4; ++i) {
    const double height = 0.182 + 0.0004 * i;
    boxes.push_back(
        {"box" + std::to_string(i), Vector3(0.257, 0.061, height), level(0.05, 0.26 - 0.063 * i, 0.5 * height)});
  }
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Estimate estimate = estimate_boxes(frame_of(cell, boxes, seed), expect(cell, boxes, seed));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(estimate.boxes[i].sight, Sight::Seen) << seed;
      EXPECT_LT((estimate.boxes[i].X_WP.p - boxes[i].X_WP.p).norm(), 10e-3) << seed << " " << boxes[i].id;
    }
  }
}

TEST(EstimateBoxes, SaysWhatIsHiddenMissingOrMoved) {
  const Cell cell;
  std::vector<Box> boxes = three_boxes();
  boxes.push_back({"under", Vector3(0.10, 0.08, 0.04), level(0.13, -0.15, 0.02)});
  boxes.push_back({"over", Vector3(0.12, 0.16, 0.05), level(0.13, -0.15, 0.065)});
  EstimateInput input = expect(cell, boxes, 3);
  std::vector<Box> real = boxes;
  real[1].X_WP = level(0.12, 0.22, 0.03, 0.3);  // b was moved by hand
  real.erase(real.begin() + 2);                 // c was taken away
  const Estimate estimate = estimate_boxes(frame_of(cell, real, 3), input);
  EXPECT_EQ(estimate.boxes[1].sight, Sight::Seen);
  EXPECT_LT((estimate.boxes[1].X_WP.p - real[1].X_WP.p).norm(), 2e-3);
  EXPECT_EQ(estimate.boxes[1].findings, std::vector<Finding>{Finding::Moved});
  EXPECT_EQ(estimate.boxes[2].sight, Sight::Missing);
  EXPECT_EQ(estimate.boxes[3].sight, Sight::Hidden);
  EXPECT_EQ(estimate.boxes[3].X_WP, input.boxes[3].X_WP);
  EXPECT_EQ(estimate.boxes[4].sight, Sight::Seen);
}

/// Each is where the other was: both places show a box that is nearly as large as the one expected.
TEST(EstimateBoxes, TellsTwoSwappedBoxesApart) {
  const Cell cell;
  const std::vector<Box> before = {{"a", Vector3(0.150, 0.110, 0.08), level(0.0, -0.15, 0.04)},
                                   {"b", Vector3(0.165, 0.120, 0.08), level(0.0, 0.15, 0.04)}};
  std::vector<Box> now = before;
  std::swap(now[0].X_WP, now[1].X_WP);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Estimate estimate = estimate_boxes(frame_of(cell, now, seed), expect(cell, before, seed));
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_EQ(estimate.boxes[i].sight, Sight::Seen) << seed;
      EXPECT_LT((estimate.boxes[i].X_WP.p - now[i].X_WP.p).norm(), 3e-3) << seed << " " << now[i].id;
    }
  }
}

/// What was on a box was taken away and put elsewhere; the one below was never seen before.
TEST(EstimateBoxes, FindsWhatWasUncoveredAndWhatCoveredIt) {
  const Cell cell;
  std::vector<Box> boxes = {{"under", Vector3(0.20, 0.16, 0.06), level(-0.05, -0.15, 0.03)},
                            {"over", Vector3(0.22, 0.18, 0.05), level(-0.05, -0.15, 0.085)}};
  const EstimateInput input = expect(cell, boxes, 7);
  // Leaning on the floor and on its edge, turned about the vertical.
  const Matrix3 R = exp_rotation(Vector3(0, 0, 0.6)) * exp_rotation(Vector3(0.7, 0, 0));
  boxes[1].X_WP = {R, Vector3(0.0, 0.16, 0.5 * (0.18 * std::sin(0.7) + 0.05 * std::cos(0.7)))};
  const Estimate estimate = estimate_boxes(frame_of(cell, boxes, 7), input);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_EQ(estimate.boxes[i].sight, Sight::Seen) << i;
    EXPECT_LT((estimate.boxes[i].X_WP.p - boxes[i].X_WP.p).norm(), 3e-3) << i;
  }
  EXPECT_EQ(estimate.boxes[1].findings, (std::vector<Finding>{Finding::Moved, Finding::Leaning}));
  EXPECT_TRUE(estimate.obstacles.empty());
}

/// Lines of pixels cross the edges of a box obliquely that is turned against the grid, and behind the ridges of one
/// that leans its own sides are seen. Neither may make its sides look longer than they are: they did by up to 2 mm.
TEST(EstimateBoxes, SidesAreAsLongAtAnyTurnAndLeaning) {
  const Cell cell("ideal");
  const Pose X_CW = cell.camera.X_WC.inverse();
  const internal::ErrorModel errors(cell.camera);
  const camera::Scene surroundings_C = internal::in_camera(camera::make_surroundings(cell.scenario), cell.camera.X_WC);
  const internal::PixelRange all{0, cell.camera.height, 0, cell.camera.width};
  const EstimatorSettings settings;
  for (const double lean : {0.0, 0.3, 0.6})
    for (int degrees = 2; degrees < 90; degrees += 5) {  // at 0 and 45 the grid rounds all lines alike
      SCOPED_TRACE(testing::Message() << "turned by " << degrees << " degrees, leaning by " << lean);
      const Matrix3 R =
          exp_rotation(Vector3(0, 0, degrees * std::numbers::pi / 180.0)) * exp_rotation(Vector3(lean, 0, 0));
      const Box box{"a", Vector3(0.10, 0.08, 0.09), {R, Vector3(0.04, 0.07, 0.12)}};
      internal::TrackedBox tracked{0.5 * box.size, X_CW * box.X_WP, X_CW * box.X_WP, 1e4 * Matrix6::Identity()};
      const camera::Frame frame = frame_of(cell, {box}, 1);
      const internal::FitResult fit =
          internal::fit_boxes({frame, all, surroundings_C, errors, settings}, {tracked}, internal::FitStart::Near, 4);
      int seen = 0;
      for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(fit.size_misfit[0](k))) continue;
        ++seen;
        // The grid of pixels, 1 mm, once at either end, evened out along edges of some eighty.
        EXPECT_NEAR(fit.size_misfit[0](k), 0.0, 0.6e-3) << "axis " << k;
      }
      EXPECT_GE(seen, 2);
      EXPECT_LT((fit.boxes[0].X_CP.p - tracked.X_CP.p).norm(), 0.6e-3);
    }
}

TEST(EstimateBoxes, ReportsWhatNobodyExpectsAsAnObstacleOfItsHeight) {
  const Cell cell;
  const std::vector<Box> boxes = three_boxes();
  std::vector<Box> real = boxes;
  real.push_back({"stranger", Vector3(0.09, 0.09, 0.12), level(0.13, -0.22, 0.06)});
  const Estimate estimate = estimate_boxes(frame_of(cell, real, 4), expect(cell, boxes, 4));
  ASSERT_EQ(estimate.obstacles.size(), 1u);
  EXPECT_NEAR(estimate.obstacles[0].high.z(), 0.12, 2e-3);
  EXPECT_NEAR(estimate.obstacles[0].low.x(), 0.085, 5e-3);
  for (const BoxEstimate& box : estimate.boxes) EXPECT_EQ(box.sight, Sight::Seen);
  const HeightMap& map = estimate.heights;
  const auto height = [&map](double x, double y) {
    return map.height(static_cast<int>((y - map.origin.y()) / map.cell),
                      static_cast<int>((x - map.origin.x()) / map.cell));
  };
  EXPECT_NEAR(height(0.13, -0.22), 0.12, 2e-3);
  EXPECT_NEAR(height(0.0, 0.28), 0.0, 2e-3);
}

TEST(EstimateBoxes, RefusesFramesThatTellNothing) {
  const Cell cell;
  const std::vector<Box> boxes = three_boxes();
  const EstimateInput input = expect(cell, boxes, 5);
  camera::Frame empty = frame_of(cell, boxes, 5);
  for (float& depth : empty.depth.values()) depth = 0.0F;
  const Estimate none = estimate_boxes(empty, input);
  EXPECT_EQ(none.fault, FrameFault::TooFewPoints);
  for (const BoxEstimate& box : none.boxes) EXPECT_EQ(box.sight, Sight::Hidden);
  std::vector<Box> blocked = boxes;  // an arm over half of the container
  blocked.push_back({"arm", Vector3(0.4, 0.3, 0.1), level(0.0, 0.15, 0.5)});
  EXPECT_EQ(estimate_boxes(frame_of(cell, blocked, 5), input).fault, FrameFault::ViewBlocked);
}

TEST(EstimateBoxes, EqualRotationsAreTheFourOfACuboid) {
  const Matrix3 R = exp_rotation(Vector3(0.3, -0.2, 0.9));
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)})
    EXPECT_LT(angle_between(nearest_equal_rotation(R * exp_rotation(3.14159265358979 * axis), R), R), 1e-6);
}

}  // namespace
}  // namespace snug::box_estimation
