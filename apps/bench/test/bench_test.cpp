// Tests of the bench: its own overlap test, and the figures that do not depend on the machine.
#include "apps/bench/bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace snug::bench {
namespace {

TEST(BoxOverlap, IsTheDepthOfFacesAndZeroApart) {
  const Vector3 half(0.1, 0.2, 0.3);
  EXPECT_NEAR(box_overlap(half, Pose{}, half, Pose{Matrix3::Identity(), Vector3(0.19, 0.0, 0.0)}), 0.01, 1e-15);
  EXPECT_EQ(box_overlap(half, Pose{}, half, Pose{Matrix3::Identity(), Vector3(0.21, 0.0, 0.0)}), 0.0);
}

TEST(BoxOverlap, SeesEdgesThatCross) {
  // Two cubes turned by 45 degrees about x and y, edge over edge: the edges meet at a distance of 2 sqrt(2) h.
  const Vector3 half = Vector3::Constant(0.1);
  const double quarter = std::numbers::pi / 4.0;
  const Pose X_WA{exp_rotation(Vector3(quarter, 0.0, 0.0)), Vector3::Zero()};
  const Pose X_WB{exp_rotation(Vector3(0.0, quarter, 0.0)), Vector3(0.0, 0.0, 0.2 * std::sqrt(2.0) - 0.001)};
  EXPECT_NEAR(box_overlap(half, X_WA, half, X_WB), 0.001, 1e-12);
}

TEST(Bench, NamesWhatIsToBeAskedForOneAtATime) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(bench_scenes("s"), (Names{"s1", "s2", "s3", "s4", "s5", "s6", "scenes"}));
  EXPECT_EQ(bench_scenes("packing.load"), Names{"packing.load"}) << "a figure of one scene";
  EXPECT_EQ(bench_scenes("nothing"), Names{});
  EXPECT_GT(bench_scenes("").size(), 15U);
  for (const std::string& scene : bench_scenes("")) EXPECT_EQ(bench_scenes(scene), Names{scene});
}

TEST(Bench, MeetsTheTargetsOfSlidingAndBouncing) {
  BenchOptions options;
  options.scenes = std::string(SNUG_SOURCE_DIR) + "/scenarios/bench";
  for (const char* scene : {"s3", "s4"}) {
    options.only = scene;
    const std::vector<Figure> figures = run_bench(options);
    EXPECT_FALSE(figures.empty());
    for (const Figure& figure : figures) EXPECT_TRUE(figure.ok) << figure.name << " " << figure.value;
  }
}

TEST(Bench, PressesABoxBetweenTwoOthersWithinTheForcesOfTheTargets) {
  BenchOptions options;
  options.scenes = std::string(SNUG_SOURCE_DIR) + "/scenarios/bench";
  options.only = "s6";
  const std::vector<Figure> figures = run_bench(options);
  EXPECT_EQ(figures.size(), 6u);
  for (const Figure& figure : figures) EXPECT_TRUE(figure.ok) << figure.name << " " << figure.value;
}

TEST(Bench, PlansTheMotionsOfMostBoxesOfTheScenario) {
  BenchOptions options;
  options.scenario = std::string(SNUG_SOURCE_DIR) + "/scenarios/box-demonstrator.yaml";
  options.only = "packing.motion.count";
  const std::vector<Figure> figures = run_bench(options);
  ASSERT_EQ(figures.size(), 1u);
  EXPECT_TRUE(figures.front().ok) << figures.front().value;
}

TEST(Bench, SaysThatInstancesAreSkippedWhenTheyAreNotThere) {
  BenchOptions options;
  options.instances = "no such folder";
  options.only = "packing.load";
  const std::vector<Figure> figures = run_bench(options);
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_FALSE(figures[0].skipped.empty());
  EXPECT_TRUE(figures[0].ok);
}

}  // namespace
}  // namespace snug::bench
