// Perception: what each kind tells of a scene, and whether stated covariances are those of the errors.
#include "snug/perception/perception.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/input_error.hpp"

namespace snug::perception {
namespace {

Scene two_boxes() {
  Scene scene;
  scene.time = 3.0;
  scene.boxes.push_back({"A", Pose{exp_rotation(Vector3(0.0, 0.0, 0.3)), Vector3(0.1, 0.2, 0.3)}, {0.2, 0.1, 0.1}});
  scene.boxes.push_back({"B", Pose{Matrix3::Identity(), Vector3(-0.1, 0.0, 0.1)}, {0.3, 0.1, 0.2}});
  return scene;
}
const std::vector<Expectation> kExpected{{"A", {0.2, 0.1, 0.1}, {}}, {"C", {0.1, 0.1, 0.1}, {}}};

TEST(Perception, ExactTellsWhatIsThereAndWhatIsMissing) {
  const Scene scene = two_boxes();
  const Observation seen = make_perception(Kind::Exact, 1)->perceive(scene, kExpected);
  EXPECT_EQ(seen.time, 3.0);
  ASSERT_EQ(seen.seen.size(), 2U);
  ASSERT_NE(find(seen, "B"), nullptr);
  EXPECT_EQ(find(seen, "B")->X_WP, scene.boxes[1].X_WP);
  EXPECT_EQ(find(seen, "B")->size, scene.boxes[1].size);
  EXPECT_TRUE(find(seen, "B")->covariance.isZero(0.0));
  EXPECT_EQ(seen.not_seen, std::vector<std::string>{"C"});
  EXPECT_EQ(seen.missing, seen.not_seen) << "nothing is hidden from it";
}

TEST(Perception, WhatNobodyToldOfIsAnObstacleToWhoLooks) {
  Scene scene = two_boxes();
  EXPECT_TRUE(make_perception(Kind::Exact, 1)->perceive(scene, {}).obstacles->empty());
  scene.objects.push_back({"stranger", Pose{Matrix3::Identity(), Vector3(0.0525, 0.0, 0.05)}, {0.095, 0.05, 0.1}});
  const Observation exact = make_perception(Kind::Exact, 1)->perceive(scene, {});
  ASSERT_EQ(exact.obstacles->size(), 1U);
  EXPECT_FALSE(exact.heights) << "it sees everything";
  EXPECT_EQ(find(exact, "stranger"), nullptr);
  const geometry::Aabb bounds = bounds_of(exact.obstacles->front().columns);
  EXPECT_NEAR(bounds.upper.x(), 0.1, 1e-12);
  EXPECT_NEAR(bounds.upper.z(), 0.1, 1e-12);
  const Observation noisy = make_perception(Kind::Noisy, 1)->perceive(scene, {});
  ASSERT_EQ(noisy.obstacles->size(), 1U);
  EXPECT_NEAR(noisy.obstacles->front().deviation, NoiseLevels{}.position / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(bounds_of(noisy.obstacles->front().columns).upper.z(), 0.1, 0.004);
  EXPECT_FALSE(make_perception(Kind::DeadReckoning, 1)->perceive(scene, {}).obstacles);
}

TEST(Perception, DeadReckoningSeesNothing) {
  const Observation seen = make_perception(Kind::DeadReckoning, 1)->perceive(two_boxes(), kExpected);
  EXPECT_TRUE(seen.seen.empty());
  EXPECT_EQ(seen.not_seen, (std::vector<std::string>{"A", "C"}));
  EXPECT_TRUE(seen.missing.empty()) << "who does not look does not know what is gone";
}

TEST(Perception, NoiseStaysWithinItsWidthsAndHasTheCovarianceThatIsStated) {
  const Scene scene = two_boxes();
  const auto noisy = make_perception(Kind::Noisy, 7);
  constexpr int kLooks = 4000;
  Matrix6 sum = Matrix6::Zero();
  Observation seen;
  for (int i = 0; i < kLooks; ++i) {
    seen = noisy->perceive(scene, {});
    const PoseEstimate& a = seen.seen[0];
    Vector6 error;
    error << a.X_WP.p - scene.boxes[0].X_WP.p, log_rotation(a.X_WP.R * scene.boxes[0].X_WP.R.transpose());
    ASSERT_LE(error.head<3>().cwiseAbs().maxCoeff(), NoiseLevels{}.position);
    ASSERT_LE(error.tail<3>().cwiseAbs().maxCoeff(), NoiseLevels{}.rotation + 1e-12);
    ASSERT_LE((*a.size - scene.boxes[0].size).cwiseAbs().maxCoeff(), NoiseLevels{}.size);
    sum += error * error.transpose();
  }
  const Matrix6 found = sum / kLooks;
  // The variance of a uniform draw's estimated variance is 0.8 / N of its square: 5 sigma are 7 %.
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(found(i, i) / seen.seen[0].covariance(i, i), 1.0, 0.07) << i;
}

TEST(Perception, NoiseIsTheSeedsAlone) {
  const auto a = make_perception(Kind::Noisy, 7), b = make_perception(Kind::Noisy, 7),
             c = make_perception(Kind::Noisy, 8);
  const Observation first = a->perceive(two_boxes(), {});
  EXPECT_EQ(first, b->perceive(two_boxes(), {}));
  EXPECT_NE(first, c->perceive(two_boxes(), {}));
  EXPECT_NE(first, a->perceive(two_boxes(), {})) << "every look has noise of its own";
}

TEST(Perception, NamesReadBackAndOthersAreRefused) {
  for (const Kind kind : {Kind::Exact, Kind::Noisy, Kind::DeadReckoning}) EXPECT_EQ(kind_of(name_of(kind)), kind);
  EXPECT_THROW((void)kind_of("perfect"), InputError);
}

}  // namespace
}  // namespace snug::perception
