// estimate_boxes asks for no order, no world and no second opinion: permuted, moved and repeated input gives the same.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation {
namespace {

using namespace test;

/// Frame and belief of boxes of which the last one is hidden, and the first was moved by hand.
struct DisturbedScene {
  DisturbedScene() {
    boxes = three_boxes();
    boxes.push_back({"under", Vector3(0.10, 0.08, 0.04), level(0.13, -0.15, 0.02)});
    boxes.push_back({"over", Vector3(0.12, 0.16, 0.05), level(0.13, -0.15, 0.065)});
    input = expect(cell, boxes, 3);
    boxes[1].X_WP = level(0.12, 0.22, 0.03, 0.3);
    frame = frame_of(cell, boxes, 3);
  }
  Cell cell;
  std::vector<Box> boxes;
  EstimateInput input;
  camera::Frame frame;
};

const BoxEstimate& estimate_of(const Estimate& estimate, const std::string& id) {
  return *std::ranges::find(estimate.boxes, id, &BoxEstimate::id);
}

TEST(EstimateBoxes, AskForNoOrder) {
  const DisturbedScene scene;
  EstimateInput backwards = scene.input;
  std::ranges::reverse(backwards.boxes);
  const Estimate a = estimate_boxes(scene.frame, scene.input), b = estimate_boxes(scene.frame, backwards);
  for (std::size_t i = 0; i < a.boxes.size(); ++i)
    EXPECT_EQ(b.boxes[i].id, a.boxes[a.boxes.size() - 1 - i].id) << "the order of the input";
  for (const BoxEstimate& one : a.boxes) {
    SCOPED_TRACE(one.id);
    const BoxEstimate& other = estimate_of(b, one.id);
    EXPECT_EQ(other.sight, one.sight);
    EXPECT_EQ(other.findings, one.findings);
    // Normal equations in another order: rounding, and pixels at a face's border that it flips.
    EXPECT_LT((other.X_WP.p - one.X_WP.p).norm(), 1e-5);
    EXPECT_LT(angle_between(other.X_WP.R, one.X_WP.R), 1e-4);
  }
}

TEST(EstimateBoxes, AreTheSameTwice) {
  const DisturbedScene scene;
  const Estimate a = estimate_boxes(scene.frame, scene.input), b = estimate_boxes(scene.frame, scene.input);
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    EXPECT_EQ(a.boxes[i].X_WP, b.boxes[i].X_WP);
    EXPECT_EQ(a.boxes[i].covariance, b.boxes[i].covariance);
    EXPECT_EQ(a.boxes[i].points, b.boxes[i].points);
  }
}

/// Camera, surroundings, beliefs and region moved together by a turn about the vertical: C sees the same.
TEST(EstimateBoxes, MoveWithTheWorldThatTheyAreSeenFrom) {
  const DisturbedScene scene;
  const Estimate here = estimate_boxes(scene.frame, scene.input);
  // A quarter turn keeps the region a region: its corners change places.
  const Pose X{exp_rotation(Vector3(0.0, 0.0, 0.5 * 3.14159265358979323846)), Vector3(0.7, -0.4, 0.1)};
  camera::Frame frame = scene.frame;
  frame.camera.X_WC = X * frame.camera.X_WC;
  EstimateInput moved = scene.input;
  for (ExpectedBox& box : moved.boxes) box.X_WP = X * box.X_WP;
  for (Pose& X_WB : moved.surroundings.X_WB) X_WB = X * X_WB;
  for (camera::SceneShape& shape : moved.surroundings.shapes) shape.X_WG = X * shape.X_WG;
  const Vector3 a = X * scene.input.region_low, b = X * scene.input.region_high;
  moved.region_low = a.cwiseMin(b);
  moved.region_high = a.cwiseMax(b);
  const Estimate there = estimate_boxes(frame, moved);
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = X.R;
  for (std::size_t i = 0; i < here.boxes.size(); ++i) {
    const BoxEstimate &one = here.boxes[i], &other = there.boxes[i];
    SCOPED_TRACE(one.id);
    EXPECT_EQ(other.sight, one.sight);
    EXPECT_EQ(other.findings, one.findings);
    EXPECT_LT((other.X_WP.p - X * one.X_WP.p).norm(), 1e-6);
    EXPECT_LT((other.X_WP.R - X.R * one.X_WP.R).norm(), 1e-5);
    const Matrix6 expected = turn * one.covariance * turn.transpose();
    EXPECT_LT((other.covariance - expected).norm(), 1e-3 * expected.norm());
    EXPECT_LT((other.common - turn * one.common).norm(), 1e-6 + 1e-3 * one.common.norm());
  }
  ASSERT_EQ(there.obstacles.size(), here.obstacles.size());
}

TEST(EstimateBoxes, HaveCovariancesThatHoldWhatTheyShare) {
  const DisturbedScene scene;
  for (const BoxEstimate& box : estimate_boxes(scene.frame, scene.input).boxes) {
    SCOPED_TRACE(box.id);
    EXPECT_LT((box.covariance - box.covariance.transpose()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(box.covariance).eigenvalues()[0], 0.0);
    if (box.sight != Sight::Seen) {
      EXPECT_EQ(box.common.norm(), 0.0) << "a belief is no camera's";
      continue;
    }
    // What is left without the camera's own part is still a covariance.
    const Matrix6 own = box.covariance - box.common * box.common.transpose();
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(own).eigenvalues()[0], 0.0);
    EXPECT_GT(box.common.norm(), 0.0);
    EXPECT_GT(box.points, 0);
    EXPECT_LE(box.visible_part, 1.0);
  }
}

TEST(EstimateBoxes, AreNotChangedByWhatIsElsewhere) {
  // A box that is believed to be far outside of the picture is hidden, and the others do not notice.
  const DisturbedScene scene;
  EstimateInput more = scene.input;
  more.boxes.push_back({"elsewhere", Vector3(0.1, 0.1, 0.1), level(5.0, 5.0, 0.05), 0.004, 0.02});
  const Estimate a = estimate_boxes(scene.frame, scene.input), b = estimate_boxes(scene.frame, more);
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    EXPECT_EQ(a.boxes[i].sight, b.boxes[i].sight) << a.boxes[i].id;
    EXPECT_LT((a.boxes[i].X_WP.p - b.boxes[i].X_WP.p).norm(), 1e-6) << a.boxes[i].id;
  }
  EXPECT_NE(b.boxes.back().sight, Sight::Seen);
  EXPECT_EQ(b.boxes.back().X_WP, more.boxes.back().X_WP);
}

TEST(EstimateBoxes, OfAContainerAloneAreNoneAndNoObstacle) {
  const Cell cell;
  const Estimate estimate = estimate_boxes(frame_of(cell, {}, 1), expect(cell, {}, 1));
  EXPECT_EQ(estimate.fault, FrameFault::None);
  EXPECT_TRUE(estimate.boxes.empty());
  EXPECT_TRUE(estimate.obstacles.empty());
  EXPECT_GT(estimate.point_part, 0.9);
}

/// The box itself turned by half about any of its axes is the same box.
TEST(EstimateBoxes, OfEqualBeliefsAreEqual) {
  const Cell cell;
  const std::vector<Box> boxes = {three_boxes()[0]};
  const EstimateInput input = expect(cell, boxes, 2);
  const camera::Frame frame = frame_of(cell, boxes, 2);
  const Estimate plain = estimate_boxes(frame, input);
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)}) {
    EstimateInput turned = input;
    const Matrix3 half_turn = 2.0 * axis * axis.transpose() - Matrix3::Identity();
    turned.boxes[0].X_WP.R = input.boxes[0].X_WP.R * half_turn;
    const Estimate other = estimate_boxes(frame, turned);
    EXPECT_LT((other.boxes[0].X_WP.p - plain.boxes[0].X_WP.p).norm(), 1e-6);
    EXPECT_LT((other.boxes[0].X_WP.R - plain.boxes[0].X_WP.R * half_turn).norm(), 1e-5) << "nearest to its belief";
  }
}

TEST(NearestEqualRotation, IsOneOfFourAndNoneOfThemIsNearer) {
  Rng rng = Rng(4).split("equal rotations");
  for (int i = 0; i < 200; ++i) {
    const Matrix3 R = exp_rotation(normals(rng, 2.0)), near = exp_rotation(normals(rng, 2.0));
    const Matrix3 best = nearest_equal_rotation(R, near);
    const Matrix3 signs = R.transpose() * best;
    EXPECT_LT((signs.cwiseAbs() - Matrix3::Identity()).norm(), 1e-12) << "turned by halves about its axes";
    EXPECT_NEAR(best.determinant(), 1.0, 1e-12);
    for (const Vector3& other : {Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1)})
      EXPECT_LE(angle_between(best, near), angle_between(R * other.asDiagonal(), near) + 1e-12);
    // From any of the four it is the same one.
    EXPECT_LT((nearest_equal_rotation(R * Vector3(-1, 1, -1).asDiagonal(), near) - best).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace snug::box_estimation
