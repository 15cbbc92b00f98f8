// fit_boxes: beliefs alone, frames alone, and solids that do not overlap.
#include "snug/box_estimation/internal/joint_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

const Box kFittedBox{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.10, 0.05, 0.3)};

/// Without any point.
FitScene blind_scene() {
  FitScene scene({});
  for (float& depth : scene.frame.depth.values()) depth = 0.0F;
  return scene;
}

TEST(FitBoxes, WithoutAPointTheBeliefIsTheResultAndItsInformationTheInverseOfTheCovariance) {
  const FitScene scene = blind_scene();
  Box high = kFittedBox;
  high.X_WP.p.z() = 0.12;  // touches nothing
  TrackedBox box = scene.tracked(high, Vector3::Zero(), Vector3::Zero(), 4e4);
  box.prior_information(3, 3) = 100.0;
  const FitResult fit = fit_boxes(scene.context(), {box}, FitStart::Belief, 6);
  EXPECT_LT(difference(box.X_CP, fit.boxes[0].X_CP).norm(), 1e-12);
  EXPECT_LT((fit.covariance[0] * box.prior_information - Matrix6::Identity()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_TRUE(fit.size_misfit[0].array().isNaN().all()) << "no edge was seen";
  EXPECT_FALSE(fit.is_larger[0]);
}

TEST(FitBoxes, APoseAwayFromItsBeliefGoesBackToItWithoutPoints) {
  const FitScene scene = blind_scene();
  Box high = kFittedBox;
  high.X_WP.p.z() = 0.12;
  TrackedBox box = scene.tracked(high, Vector3::Zero(), Vector3::Zero(), 1e4);
  box.X_CP = {exp_rotation(Vector3(0.02, -0.01, 0.03)) * box.X_CP.R, box.X_CP.p + Vector3(0.004, 0.002, -0.003)};
  const FitResult fit = fit_boxes(scene.context(), {box}, FitStart::Near, 3);
  EXPECT_LT(difference(box.X_CP_prior, fit.boxes[0].X_CP).norm(), 1e-9);
}

/// Two boxes of equal beliefs of p = 1 / sigma^2, 5 mm in each other along one axis with four points of contact: each
/// gives way by w d / (p + 2 w), w = 4 / overlap^2.
TEST(FitBoxes, SolidsThatOverlapGiveWayAlikeByTheClosedForm) {
  const FitScene scene = blind_scene();
  const double deep = 0.005, information = 1e6;
  const Box a{"a", Vector3(0.10, 0.10, 0.10), level(0.0, 0.0, 0.12)};
  Box b = a;
  b.X_WP.p.x() = 0.10 - deep;
  const std::vector<TrackedBox> boxes = {scene.tracked(a, Vector3::Zero(), Vector3::Zero(), information),
                                         scene.tracked(b, Vector3::Zero(), Vector3::Zero(), information)};
  const FitResult fit = fit_boxes(scene.context(), boxes, FitStart::Near, 3);
  const Vector3 of_a = fit.boxes[0].X_CP.p - boxes[0].X_CP.p, of_b = fit.boxes[1].X_CP.p - boxes[1].X_CP.p;
  EXPECT_LT((of_a + of_b).norm(), 1e-9) << "each as much as the other";
  const double w = 4.0 / std::pow(scene.settings.fit.overlap, 2);
  EXPECT_NEAR(of_a.norm(), w * deep / (information + 2.0 * w), 1e-6);
  EXPECT_LT(overlap(fit.boxes[0], fit.boxes[1]), deep);
}

TEST(FitBoxes, BoxesDeeperInEachOtherThanAFitCanBeOffAreNotPushed) {
  FitScene scene = blind_scene();
  const Box a{"a", Vector3(0.10, 0.10, 0.10), level(0.0, 0.0, 0.12)};
  Box b = a;
  b.X_WP.p.x() = 0.10 - 0.04;
  const std::vector<TrackedBox> boxes = {scene.tracked(a, Vector3::Zero(), Vector3::Zero(), 1e4),
                                         scene.tracked(b, Vector3::Zero(), Vector3::Zero(), 1e4)};
  EXPECT_LT(difference(boxes[0].X_CP, fit_boxes(scene.context(), boxes, FitStart::Near, 3).boxes[0].X_CP).norm(),
            1e-12);
  scene.settings.fit.deepest_overlap = 0.05;
  EXPECT_GT(difference(boxes[0].X_CP, fit_boxes(scene.context(), boxes, FitStart::Near, 3).boxes[0].X_CP).norm(), 1e-3);
}

TEST(FitBoxes, HeldBoxesStayAndAreNotMeasured) {
  const std::vector<Box> both = {kFittedBox, {"b", Vector3(0.10, 0.12, 0.06), level(0.10, 0.12, 0.03)}};
  const FitScene scene(both);
  const std::vector<TrackedBox> boxes = {scene.tracked(both[0], Vector3(0.002, 0, 0.002)),
                                         scene.tracked(both[1], Vector3(0.002, 0, 0.002))};
  const FitResult fit = fit_boxes(scene.context(), boxes, FitStart::Near, 4, 1);
  EXPECT_EQ(fit.boxes[0].X_CP, boxes[0].X_CP);
  EXPECT_EQ(fit.covariance[0], Matrix6(Matrix6::Zero()));
  EXPECT_LT(difference(scene.tracked(both[1]).X_CP, fit.boxes[1].X_CP).head<3>().norm(), 0.5e-3);
}

TEST(FitBoxes, FindsTheTruthFromAnyBeliefNearby) {
  const FitScene scene({kFittedBox});
  Rng rng = Rng(6).split("joint fit");
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const TrackedBox from = scene.tracked(kFittedBox, normals(rng, 0.005), normals(rng, 0.02), 1.0);
    const FitResult fit = fit_boxes(scene.context(), {from}, FitStart::Belief, 6);
    const Vector6 off = difference(scene.tracked(kFittedBox).X_CP, fit.boxes[0].X_CP);
    EXPECT_LT(off.head<3>().norm(), 0.5e-3);
    EXPECT_LT(off.tail<3>().norm(), 0.004);
    EXPECT_LT(off.dot(fit.covariance[0].ldlt().solve(off)), 22.5) << "chi-square of six degrees, one of a thousand";
  }
}

TEST(FitBoxes, AStrongBeliefIsNotMovedByTheFrame) {
  const FitScene scene({kFittedBox});
  const Vector3 off(0.003, 0, 0);
  const FitResult fit =
      fit_boxes(scene.context(), {scene.tracked(kFittedBox, off, Vector3::Zero(), 1e14)}, FitStart::Near, 4);
  EXPECT_LT((fit.boxes[0].X_CP.p - scene.tracked(kFittedBox, off).X_CP.p).norm(), 1e-5);
}

TEST(KeptOf, WhatWasFoundOfABoxStaysWithIt) {
  const std::vector<Box> all = {kFittedBox,
                                {"b", Vector3(0.10, 0.12, 0.06), level(0.10, 0.12, 0.03)},
                                {"c", Vector3(0.08, 0.10, 0.05), level(-0.10, 0.20, 0.025)}};
  const FitScene scene(all);
  std::vector<TrackedBox> boxes;
  for (const Box& box : all) boxes.push_back(scene.tracked(box, Vector3(0.001, 0, 0)));
  const FitResult fit = fit_boxes(scene.context(), boxes, FitStart::Near, 3);
  const FitResult kept = kept_of(fit, {false, true, true});
  ASSERT_EQ(kept.boxes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(kept.boxes[i].X_CP, fit.boxes[i + 1].X_CP);
    EXPECT_EQ(kept.covariance[i], fit.covariance[i + 1]);
    EXPECT_EQ(kept.size_error[i], fit.size_error[i + 1]);
    EXPECT_EQ(kept.is_larger[i], fit.is_larger[i + 1]);
    for (int k = 0; k < 3; ++k) {
      const double own = fit.size_misfit[i + 1](k), now = kept.size_misfit[i](k);
      EXPECT_TRUE(own == now || (std::isnan(own) && std::isnan(now)));
    }
  }
  EXPECT_NE(fit.size_error[0], fit.size_error[1]) << "boxes of other errors";
  EXPECT_TRUE(kept_of(fit, {false, false, false}).boxes.empty());
}

TEST(FitBoxes, NothingToFitIsNothing) {
  const FitScene scene({kFittedBox});
  EXPECT_TRUE(fit_boxes(scene.context(), {}, FitStart::Near, 4).boxes.empty());
}

}  // namespace
}  // namespace snug::box_estimation::internal
