// Every shipped scenario loads; the bench scenes are what their definitions say.
#include <gtest/gtest.h>

#include <cmath>

#include "scenario_text.hpp"

namespace snug::model {
namespace {

Scenario bench(const std::string& name) {
  return load_scenario(test::project_file("scenarios/bench/" + name + ".yaml"));
}

TEST(ShippedScenarios, AllLoad) {
  const auto files = test::shipped_scenarios();
  EXPECT_GE(files.size(), 16u);
  for (const auto& file : files) {
    SCOPED_TRACE(file.filename());
    try {
      const Scenario scenario = load_scenario(file);
      const bool is_template = file.parent_path().filename() == "init";
      EXPECT_EQ(scenario.name, (is_template ? "my-" : "") + file.stem().string());
      EXPECT_EQ(scenario.source_text, test::read_text(file));
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

TEST(BenchScenes, S1IsATightStackOfFourteenBoxes) {
  const Scenario s = bench("s1-stack");
  ASSERT_EQ(s.bodies.size(), 14u);
  EXPECT_EQ(s.duration, 10.0);
  EXPECT_FALSE(s.solver.sleep.enabled);
  EXPECT_EQ(find_container(s, s.target)->inner_size, Vector3(0.57, 0.37, 0.25));
  const auto at = [&](const char* name) -> Vector3 { return find_body(s, name)->X_WB.p; };
  EXPECT_LT((at("b3-1") - Vector3(-0.1545, -0.092333, 0.0312)).norm(), 1e-9);
  EXPECT_LT((at("b3-4") - Vector3(0.1055, 0.092334, 0.0312)).norm(), 1e-9);
  EXPECT_LT((at("b4-3") - Vector3(0.143, -0.0665, 0.1094)).norm(), 1e-9);
  EXPECT_LT((at("b2-5") - Vector3(0.1925, 0.112, 0.1164)).norm(), 1e-9);
  EXPECT_LT((at("b1-1") - Vector3(0.076, -0.074, 0.2051)).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(find_body(s, "b3-1")->X_WB.R(1, 0), 1.0);  // long edge (body y) along x
  double mass = 0.0;
  for (const Body& body : s.bodies) mass += body.inertia.mass;
  EXPECT_NEAR(mass, 5 * 1.05 + 3 * 0.95 + 5 * 0.26 + 0.55, 1e-12);
}

TEST(BenchScenes, S2DropsTwelveRandomBoxes) {
  const Scenario s = bench("s2-drop");
  ASSERT_TRUE(s.drops.has_value());
  EXPECT_EQ(s.drops->count, 12);
  EXPECT_EQ(s.drops->interval, 0.5);
  EXPECT_EQ(s.drops->clearance, 0.05);
  EXPECT_EQ(s.drops->types.size(), 4u);
  EXPECT_EQ(s.duration, 8.0);
  const Body& ground = *find_body(s, "ground");
  EXPECT_NEAR(ground.X_WB.p.z() + 0.05, -0.011, 1e-15);
}

TEST(BenchScenes, S3SlidesAtOneMetrePerSecondOnFrictionOfAFifth) {
  for (const auto& [name, degrees] : {std::pair{"s3-slide-0", 0.0}, {"s3-slide-22", 22.5}, {"s3-slide-45", 45.0}}) {
    const Scenario s = bench(name);
    const Body& slider = *find_body(s, "slider");
    EXPECT_NEAR(slider.V_WB.linear.norm(), 1.0, 1e-15);
    EXPECT_NEAR(std::atan2(slider.V_WB.linear.y(), slider.V_WB.linear.x()) * 180.0 / M_PI, degrees, 1e-12);
    EXPECT_EQ(find_contact(s, {0}, {1}).value(), (ContactParams{0.2, 0.0, {}, {}, {}, {}, {}, {}}));
    EXPECT_EQ(slider.X_WB.p.z(), 0.0485);
  }
  const Vector3 g = bench("s3-creep").gravity;
  EXPECT_NEAR(g.norm(), 9.81, 1e-12);
  EXPECT_NEAR(std::hypot(g.x(), g.y()) / -g.z(), 0.1, 1e-15);
  EXPECT_NEAR(std::atan2(g.y(), g.x()), 0.4, 1e-15);
}

TEST(BenchScenes, S4FallsHalfAMetre) {
  const Scenario s = bench("s4-bounce");
  EXPECT_NEAR(find_body(s, "box1")->X_WB.p.z() - 0.0485, 0.5, 1e-15);
  EXPECT_EQ(find_contact(s, {0}, {1}).value().restitution, 0.5);
}

TEST(BenchScenes, S5SwingsSixtyDegreesAtARadiusOfSixtyCentimetres) {
  const Scenario s = bench("s5-swing");
  ASSERT_EQ(s.springs.size(), 1u);
  const Spring& cup = s.springs[0];
  EXPECT_EQ(cup.stiffness, (CupElasticity{2000, 5000, 20, 5, 0}));
  EXPECT_EQ(cup.damping, (CupElasticity{6, 10, 0.04, 0.02, 0}));
  EXPECT_LT((cup.X_WH.p - Vector3(0.6, 0, 0)).norm(), 1e-15);
  const Vector3 end = holder_at(cup, 4.0).X_WH.p;
  EXPECT_LT((end - Vector3(0.3, 0.6 * std::sqrt(0.75), 0)).norm(), 1e-15);
}

TEST(BenchScenes, S6PressesABoxIntoGapsOfTheStatedWidth) {
  for (const auto& [name, gap] : {std::pair{"s6a", 0.171}, {"s6b", 0.165}, {"s6c", 0.165}}) {
    const Scenario s = bench(name);
    const double left = find_body(s, "left")->X_WB.p.x() + 0.085;
    const double right = find_body(s, "right")->X_WB.p.x() - 0.085;
    EXPECT_NEAR(right - left, gap, 1e-12);
    EXPECT_NEAR(find_body(s, "left")->X_WB.p.x() - 0.085 - (find_body(s, "wall-left")->X_WB.p.x() + 0.025), 0.020,
                1e-12);
    const Spring& press = s.springs.at(0);
    // The path ends 2 mm below touching: centre at 45 mm. A box flat on the neighbours is then 96 mm above it, so each
    // of the two carries (5000 * 0.096 + 0.95 * 9.81) / 2 = 244.7 N.
    const Pose X_WB = holder_at(press, 100.0).X_WH * press.X_BS.inverse();
    EXPECT_NEAR(X_WB.p.z(), 0.045, 1e-6);
    EXPECT_NEAR((5000 * (0.141 - X_WB.p.z()) + 0.95 * 9.81) / 2, 245.0, 3.0);
  }
  const Scenario b = bench("s6b");
  const Pose X_WB = holder_at(b.springs[0], 1.5).X_WH * b.springs[0].X_BS.inverse();
  EXPECT_LT((X_WB.p - Vector3(0, 0, 0.0985)).norm(), 1e-6);
  EXPECT_NEAR(angle_between(X_WB.R, Matrix3::Identity()) * 180.0 / M_PI, 25.0, 1e-9);
}

}  // namespace
}  // namespace snug::model
