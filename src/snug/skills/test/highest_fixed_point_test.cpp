// Highest fixed point: every kind of fixed thing counts, as high as it reaches.
#include "snug/skills/highest_fixed_point.hpp"

#include <gtest/gtest.h>

#include <string>

#include "snug/geometry/convex_hull.hpp"
#include "snug/skills/test/demonstrator.hpp"

namespace snug::skills {
namespace {

constexpr double kTop = 0.4;  ///< m, z in W

model::Scenario with_body(const geometry::Shape& shape, const Pose& X_WB) {
  model::Scenario scenario = demonstrator();
  model::Body body;
  body.name = "post";
  body.kind = model::BodyKind::Static;
  body.shapes.push_back({shape, Pose{}});
  body.X_WB = X_WB;
  scenario.bodies.push_back(body);
  return scenario;
}

geometry::Shape pyramid() {
  const auto hull = geometry::make_convex_hull(
      std::vector<Vector3>{{-0.1, -0.1, 0.0}, {0.1, -0.1, 0.0}, {0.0, 0.1, 0.0}, {0.0, 0.0, 0.3}});
  EXPECT_TRUE(hull.has_value());
  return *hull;
}

TEST(HighestFixedPoint, IsTheBenchOfTheDemonstrator) { EXPECT_NEAR(highest_fixed_point(demonstrator()), 0.0, 1e-12); }

TEST(HighestFixedPoint, CountsBoxesCapsulesAndHullsAsTheyStand) {
  const Vector3 p(0.0, 0.5, 0.1);
  EXPECT_NEAR(highest_fixed_point(with_body(geometry::Box{Vector3(0.1, 0.1, 0.3)}, Pose{Matrix3::Identity(), p})), kTop,
              1e-12);
  EXPECT_NEAR(highest_fixed_point(
                  with_body(geometry::Capsule{.half_length = 0.2, .radius = 0.1}, Pose{Matrix3::Identity(), p})),
              kTop, 1e-12);
  EXPECT_NEAR(highest_fixed_point(with_body(pyramid(), Pose{Matrix3::Identity(), p})), kTop, 1e-12);
}

TEST(HighestFixedPoint, CountsTheAlignersPlatesAndOtherContainersButNotTheTarget) {
  model::Scenario scenario = demonstrator();
  scenario.aligner->plates.push_back(
      {geometry::Box{Vector3(0.1, 0.005, 0.2)}, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.2)}});
  EXPECT_NEAR(highest_fixed_point(scenario), scenario.aligner->X_WA.p.z() + 0.4, 1e-12);

  scenario = demonstrator();
  scenario.containers[1].inner_size.z() = 0.9;
  EXPECT_NEAR(highest_fixed_point(scenario), scenario.containers[1].X_WT.p.z() + 0.9, 1e-12);
  scenario = demonstrator();
  scenario.containers[0].inner_size.z() = 0.9;
  EXPECT_NEAR(highest_fixed_point(scenario), 0.0, 1e-12);
}

}  // namespace
}  // namespace snug::skills
