// Plant: the words for how motions end, and the contract on the smallest plant there can be.
#include <gtest/gtest.h>

#include "snug/plant/test/kinematic_plant.hpp"
#include "snug/plant/test/suite/plant_contract.hpp"

namespace snug::plant {
namespace {

motion::Waypoint waypoint_at(double z, bool vacuum) {
  return motion::make_waypoint(motion::MotionClass::Home, {}, {Matrix3::Identity(), Vector3(0.0, 0.0, z)},
                               {.vacuum = vacuum});
}

PlantCase kinematic() {
  PlantCase one;
  one.name = "kinematic";
  one.make = [] { return std::make_unique<test::KinematicPlant>(); };
  one.item = "BOX";
  one.free_waypoint = waypoint_at(0.5, false);
  one.pick = {waypoint_at(0.09, true), waypoint_at(0.4, true)};
  one.pressing = waypoint_at(0.05, false);
  return one;
}

INSTANTIATE_TEST_SUITE_P(Kinematic, PlantContract, testing::Values(kinematic()));

TEST(End, SaysWhatItWasAndWhere) {
  motion::Waypoint place;
  place.motion_class = motion::MotionClass::Place;
  place.item = "BOX027";
  EXPECT_EQ(describe({EndReason::ForceGuard, motion::WaypointIndex(0), 61.2, 60.0, ""}, {&place, 1}),
            "force guard: 61 N of 60 N toward Place(BOX027)");
  EXPECT_EQ(describe({EndReason::ProtectiveStop, motion::WaypointIndex(0), 0.0, 0.0, "joint torque of elbow"}, {}),
            "protective stop: joint torque of elbow");
  EXPECT_EQ(describe({}, {&place, 1}), "completed");
}

}  // namespace
}  // namespace snug::plant
