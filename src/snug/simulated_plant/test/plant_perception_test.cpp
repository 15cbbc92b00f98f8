// What a simulated plant tells of its boxes: exact, with noise of the stated covariance, or nothing; of lost ones, too.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "snug/simulated_plant/test/demo_rows.hpp"

namespace snug::simulated_plant {
namespace {

using namespace test;
using perception::Kind;
using plant::EndReason;

SimulatedPlantOptions seen_by(Kind kind, std::uint64_t seed, std::string_view faults = {}) {
  SimulatedPlantOptions options = nominal(faults);
  options.perception = kind;
  options.seed = seed;
  return options;
}

std::vector<perception::Expectation> all_items() {
  std::vector<perception::Expectation> expected;
  for (const std::string_view item : kItems) expected.push_back({std::string(item), Vector3::Constant(0.1), {}});
  return expected;
}

TEST(PlantPerception, ExactIsTheTruthToTheLastBit) {
  SimulatedPlantOptions options = seen_by(Kind::Exact, 5);
  options.set = {{"parcel_clearance", "0.0005"}};  // what is seen is the box as it collides
  SimulatedPlant plant(three_boxes(), "1", options);
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX028")));
  const perception::Observation seen = plant::observe(plant, all_items());
  EXPECT_EQ(seen.time, plant.read().time);
  ASSERT_EQ(seen.seen.size(), 2U);
  for (const std::string id : {"BOX027", "BOX028"}) {
    const perception::PoseEstimate* one = perception::find(seen, id);
    ASSERT_NE(one, nullptr);
    EXPECT_EQ(one->X_WP, pose_of(plant, id));
    const model::Scenario& cell = plant.simulation().scenario();
    EXPECT_EQ(one->size, model::collision_size(cell, *model::find_parcel(cell, id))) << "of the plant, not the planner";
    EXPECT_NE(one->size, model::collision_size(three_boxes(), *model::find_parcel(three_boxes(), id)));
  }
  EXPECT_EQ(seen.not_seen, std::vector<std::string>{"BOX013"});
  EXPECT_EQ(seen.missing, seen.not_seen);
}

/// Around the truth of a box that was packed; covariance and mean over two thousand looks.
TEST(PlantPerception, NoiseHasTheCovarianceThatIsStatedAndNoMean) {
  SimulatedPlant plant(three_boxes(), "1", seen_by(Kind::Noisy, 5));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
  const Pose X_WP = pose_of(plant, "BOX027");
  constexpr int kLooks = 2000;
  Matrix6 sum = Matrix6::Zero();
  Vector6 mean = Vector6::Zero();
  Matrix6 stated;
  for (int look = 0; look < kLooks; ++look) {
    const perception::Observation seen = plant::observe(plant, {});
    ASSERT_EQ(seen.seen.size(), 1U);
    Vector6 error;
    error << seen.seen[0].X_WP.p - X_WP.p, log_rotation(seen.seen[0].X_WP.R * X_WP.R.transpose());
    sum += error * error.transpose() / kLooks;
    mean += error / kLooks;
    stated = seen.seen[0].covariance;
  }
  const double five = 5.0 / std::sqrt(static_cast<double>(kLooks));
  for (int i = 0; i < 6; ++i) {
    const double deviation = std::sqrt(stated(i, i));
    EXPECT_NEAR(mean[i], 0.0, five * deviation) << i;
    for (int j = 0; j < 6; ++j) {
      const double scale = deviation * std::sqrt(stated(j, j));
      // Of a uniform draw the square has a deviation of sqrt(0.8) times its mean, a product of two of 1.
      EXPECT_NEAR(sum(i, j), stated(i, j), five * scale) << i << ", " << j;
    }
  }
  EXPECT_EQ(pose_of(plant, "BOX027"), X_WP) << "looks move nothing";
}

TEST(PlantPerception, NoiseIsTheSeedsAndSoIsThePlant) {
  const auto look = [](std::uint64_t seed) {
    SimulatedPlant plant(three_boxes(), "1", seen_by(Kind::Noisy, seed));
    EXPECT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
    return plant::observe(plant, all_items());
  };
  EXPECT_EQ(look(3), look(3));
  EXPECT_NE(look(3), look(4));
}

TEST(PlantPerception, DeadReckoningSeesNeitherBoxesNorWhatFaultsDo) {
  SimulatedPlant sound(three_boxes(), "1", seen_by(Kind::DeadReckoning, 0));
  SimulatedPlant moved(three_boxes(), "1", seen_by(Kind::DeadReckoning, 0, "displace@1,object@1"));
  for (SimulatedPlant* plant : {&sound, &moved}) ASSERT_EQ(pack(*plant, "BOX027").end.reason, EndReason::Completed);
  perception::Observation a = plant::observe(sound, all_items()), b = plant::observe(moved, all_items());
  a.time = b.time = 0.0;  // the fault took its time to rest
  EXPECT_EQ(a, b);
  EXPECT_TRUE(a.seen.empty());
  EXPECT_TRUE(a.missing.empty());
  EXPECT_FALSE(a.obstacles);
}

/// Past the edge of the bench, let go over the ground; and over nothing.
plant::Motion throwing_out(const std::string& item) {
  plant::Motion motion = pick_of(item);
  motion::Waypoint out = motion.waypoints.back();
  out.motion_class = motion::MotionClass::PrePlace;
  out.X_WE.p = Vector3(1.3, -0.4, 0.5);
  motion.waypoints.push_back(out);
  out.motion_class = motion::MotionClass::Place;
  out.io = {.blow_off = true};
  motion.waypoints.push_back(out);
  out.motion_class = motion::MotionClass::PostPlace;
  out.io = {};
  out.X_WE.p.z() += 0.2;
  motion.waypoints.push_back(out);
  return motion;
}

TEST(ABoxThatIsThrownOut, LiesOnTheGroundAndIsSeenThere) {
  model::Scenario scenario = three_boxes();
  scenario.motion_guards.exact_settle = scenario.motion_guards.longest_settle = 3.0;
  SimulatedPlant plant(scenario, "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  ASSERT_EQ(plant::run(plant, throwing_out("BOX027")).end.reason, EndReason::Completed);
  const perception::Observation seen = plant::observe(plant, all_items());
  ASSERT_NE(perception::find(seen, "BOX027"), nullptr);
  const Vector3 p_W = perception::find(seen, "BOX027")->X_WP.p;
  EXPECT_LT(p_W.z(), -0.6);
  EXPECT_GT(p_W.z(), -0.85);
  ASSERT_EQ(plant.boxes().size(), 1U);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Dropped);
  EXPECT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed) << "and packing goes on";
}

TEST(ABoxThatIsThrownOut, IsLostWhereNothingEndsItsFallAndPackingGoesOn) {
  model::Scenario bottomless = three_boxes();
  std::erase_if(bottomless.bodies, [](const model::Body& body) { return body.name == "ground"; });
  bottomless.motion_guards.exact_settle = bottomless.motion_guards.longest_settle = 16.0;
  SimulatedPlant plant(bottomless, "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Feedback thrown = plant::run(plant, throwing_out("BOX027"));
  EXPECT_EQ(thrown.end.reason, EndReason::Completed) << plant::describe(thrown.end, {});
  ASSERT_EQ(plant.work().lost.size(), 1U);
  const cell::LostBody& lost = plant.work().lost[0];
  EXPECT_EQ(lost.name, "BOX027");
  // It fell from half a metre: v^2 = 2 g h. A push of some decimetres a second at first adds nothing to that.
  EXPECT_NEAR(lost.v_W.norm(), std::sqrt(2.0 * 9.81 * (0.5 - lost.p_W.z())), 0.3);
  EXPECT_EQ(perception::find(plant::observe(plant, all_items()), "BOX027"), nullptr);
  ASSERT_EQ(plant.boxes().size(), 1U);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Lost);
  EXPECT_FALSE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  EXPECT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed);
}

}  // namespace
}  // namespace snug::simulated_plant
