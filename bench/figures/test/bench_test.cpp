// Tests of the bench: its own overlap test, and the figures that do not depend on the machine.
#include "bench/figures/bench.hpp"
#include "bench/figures/figure_text.hpp"

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

TEST(Bench, InputsAreInTheFolderOfScenarios) {
  const BenchOptions inputs = find_inputs("place/scenarios");
  EXPECT_EQ(inputs.scenes, "place/scenarios/bench");
  EXPECT_EQ(inputs.instances, "place/../shared/data/packing");
  EXPECT_EQ(inputs.program, "out/sequence-1.csv") << "where there is no program of the demonstrator";
  EXPECT_EQ(inputs.corrections, "");
}

TEST(FigureText, ComesBackFromItsJson) {
  const Figure met{"s3.error", 0.5, "%", "<= 1", true, {}},
      skipped{"packing.load", std::nan(""), "%", "", true, "no folder"};
  const auto json = nlohmann::ordered_json::parse(format_json({met, skipped}));
  ASSERT_EQ(json.at("results").size(), 2U);
  EXPECT_EQ(json.at("settings").at("tolerance_m_s"), model::SolverSettings{}.tolerance);
  const Figure back = read_figure(json.at("results").at(0));
  EXPECT_EQ(back.name, met.name);
  EXPECT_EQ(back.value, met.value);
  EXPECT_EQ(back.target, met.target);
  EXPECT_TRUE(back.ok);
  EXPECT_TRUE(std::isnan(read_figure(json.at("results").at(1)).value));
  EXPECT_EQ(read_figure(json.at("results").at(1)).skipped, "no folder");
}

TEST(FigureText, TableSaysWhatMissedItsTarget) {
  const std::string table = format_table(
      {{"a", 1.0, "us", "<= 2", true, {}}, {"b", 3.0, "us", "<= 2", false, {}}, {"c", 0.0, "", "", true, "not here"}});
  EXPECT_NE(table.find("<= 2       yes\n"), std::string::npos) << table;
  EXPECT_NE(table.find("<= 2       NO\n"), std::string::npos) << table;
  EXPECT_NE(table.find("skipped: not here\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace snug::bench
