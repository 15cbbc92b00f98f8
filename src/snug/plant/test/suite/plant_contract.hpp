// PlantContract: what every Plant promises, run on any implementation: include, instantiate with a way to make one.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/plant/plant.hpp"

namespace snug::plant {

/// A plant under test and what there is to do in it.
struct PlantCase {
  std::string name;
  std::function<std::unique_ptr<Plant>()> make;
  std::string item;                    ///< that can be brought
  motion::Waypoint free_waypoint;      ///< in free air, reachable from the start
  double tolerance = 0.01;             ///< m, of its arrival
  std::vector<motion::Waypoint> pick;  ///< picks the item once it was brought and lifts it; vacuum on at its end
  motion::Waypoint pressing;           ///< after `pick` was undone: presses on what does not give way by 20 N or more
};
inline void PrintTo(const PlantCase& one, std::ostream* out) { *out << one.name; }

/// The demonstrator's BOX027 at the aligner: motions over it and the case of a plant that has it.
struct BoxAtAligner {
  Pose X_WP;
  double pick_length = 0.0;  ///< m, of E over its upper face where the cup seals

  /// z: m, of E over its upper face.
  [[nodiscard]] motion::Waypoint over(double z, const char* name, bool vacuum) const {
    motion::Waypoint waypoint =
        motion::named_waypoint(name, {motion::upright_tool(std::numbers::pi), X_WP.p}, {.vacuum = vacuum});
    waypoint.X_WE.p.z() += 0.5 * 0.092 + z;
    return waypoint;
  }
  [[nodiscard]] std::vector<motion::Waypoint> pick() const {
    return {over(0.2, "PrePick(BOX027)", false), over(pick_length, "Box(BOX027)", false),
            over(0.3, "PostPick(BOX027)", true)};
  }
  [[nodiscard]] PlantCase plant_case(const std::string& name, std::function<std::unique_ptr<Plant>()> make) const {
    PlantCase one;
    one.name = name;
    one.make = std::move(make);
    one.item = "BOX027";
    one.free_waypoint = over(0.35, "home", false);
    one.pick = pick();
    one.pressing = over(0.03, "PlaceSlow", false);
    return one;
  }
};

class PlantContract : public testing::TestWithParam<PlantCase> {
 protected:
  void SetUp() override { plant_ = GetParam().make(); }
  [[nodiscard]] Feedback go(std::vector<motion::Waypoint> waypoints, Guards guards = {}) {
    return plant_->submit({GetParam().item, std::move(waypoints), guards});
  }
  [[nodiscard]] static std::vector<perception::Expectation> item_alone() {
    return {{GetParam().item, Vector3::Constant(0.1), std::nullopt}};
  }
  std::unique_ptr<Plant> plant_;
};

TEST_P(PlantContract, StandsAtTheStartWithNoVacuum) {
  const Feedback start = plant_->read();
  EXPECT_EQ(start.end.reason, EndReason::Completed);
  EXPECT_TRUE(start.X_WE.p.allFinite());
  EXPECT_EQ(start.V_WE.linear.norm(), 0.0);
  EXPECT_EQ(start.pressure_gauge, 0.0);
  EXPECT_FALSE(start.io.vacuum);
  EXPECT_EQ(start.q.size(), plant_->describe().joints.size());
  EXPECT_FALSE(plant_->describe().name.empty());
}

TEST_P(PlantContract, ReadingChangesNothing) {
  const Feedback first = plant_->read();
  EXPECT_EQ(first, plant_->read());
}

TEST_P(PlantContract, BringsEachItemOnce) {
  EXPECT_FALSE(plant_->bring("no such item"));
  EXPECT_TRUE(plant_->bring(GetParam().item));
  EXPECT_FALSE(plant_->bring(GetParam().item));
}

TEST_P(PlantContract, EveryExpectedItemIsEitherSeenOrNot) {
  std::vector<perception::Expectation> expected = item_alone();
  expected.push_back({"no such item", Vector3::Constant(0.1), std::nullopt});
  for (const bool is_there : {false, true}) {
    if (is_there) {
      EXPECT_TRUE(plant_->bring(GetParam().item));
    }
    const perception::Observation seen = plant_->perceive(expected);
    for (const perception::Expectation& one : expected) {
      const bool not_seen = std::ranges::find(seen.not_seen, one.item) != seen.not_seen.end();
      EXPECT_NE(perception::find(seen, one.item) != nullptr, not_seen) << one.item;
    }
    EXPECT_EQ(perception::find(seen, "no such item"), nullptr);
    if (!is_there) {
      EXPECT_EQ(perception::find(seen, GetParam().item), nullptr) << "it has not come yet";
    }
  }
}

TEST_P(PlantContract, RefusesMotionsThatCannotBeAndDoesNotMove) {
  const Feedback before = plant_->read();
  EXPECT_EQ(go({}).end.reason, EndReason::Refused);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    motion::Waypoint waypoint = GetParam().free_waypoint;
    waypoint.X_WE.p.x() = bad;
    EXPECT_EQ(go({GetParam().free_waypoint, waypoint}).end.reason, EndReason::Refused);
    waypoint = GetParam().free_waypoint;
    waypoint.X_WE.R(0, 0) = bad;
    EXPECT_EQ(go({waypoint}).end.reason, EndReason::Refused);
  }
  motion::Waypoint nameless = GetParam().free_waypoint;
  nameless.motion_class = motion::MotionClass::Other;
  nameless.variant = "no limits are known for this";
  const EndReason reason = go({nameless}).end.reason;
  EXPECT_TRUE(reason == EndReason::Refused || reason == EndReason::Completed);
  if (reason == EndReason::Refused) {
    EXPECT_EQ(plant_->read().X_WE, before.X_WE);
  }
}

TEST_P(PlantContract, ComesToAWaypointAndStands) {
  const Feedback start = plant_->read();
  const Feedback there = go({GetParam().free_waypoint});
  ASSERT_EQ(there.end.reason, EndReason::Completed) << describe(there.end, {});
  EXPECT_EQ(there.end.waypoint, 0);
  EXPECT_LE((there.X_WE.p - GetParam().free_waypoint.X_WE.p).norm(), GetParam().tolerance);
  EXPECT_LT(there.V_WE.linear.norm(), 0.01);
  EXPECT_GT(there.time, start.time);
  ASSERT_EQ(there.times.size(), 1u);
  EXPECT_GT(there.times[0].moving, 0.0);
  EXPECT_NEAR(there.times[0].moving + there.times[0].waiting, there.time - start.time, 1e-9) << "rounding of sums";
  EXPECT_EQ(plant_->read().X_WE, there.X_WE);
}

TEST_P(PlantContract, SaysWhenNothingSealsAndGoesOnAfterwards) {
  motion::Waypoint sucking = GetParam().free_waypoint;
  sucking.io.vacuum = true;
  const Feedback fed = go({GetParam().free_waypoint, sucking, GetParam().free_waypoint});
  EXPECT_EQ(fed.end.reason, EndReason::NoSeal);
  EXPECT_GT(fed.end.value, fed.end.limit) << "gauge pressures: nearer to zero than what is needed";
  EXPECT_EQ(go({GetParam().free_waypoint}).end.reason, EndReason::Completed);
  EXPECT_FALSE(plant_->read().io.vacuum);
}

TEST_P(PlantContract, WithoutThatGuardItGoesOn) {
  motion::Waypoint sucking = GetParam().free_waypoint;
  sucking.io.vacuum = true;
  EXPECT_EQ(go({GetParam().free_waypoint, sucking}, {std::nullopt, false}).end.reason, EndReason::Completed);
}

TEST_P(PlantContract, PicksAndFeelsTheVacuumAndTheWeight) {
  ASSERT_TRUE(plant_->bring(GetParam().item));
  const Feedback held = go(GetParam().pick);
  ASSERT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, GetParam().pick);
  EXPECT_LT(held.pressure_gauge, -1.0e4);
  EXPECT_TRUE(held.io.vacuum);
  EXPECT_GT(held.F_E.force.norm(), 0.5) << "N";
  EXPECT_GE(held.peak_force, held.F_E.force.norm());
}

TEST_P(PlantContract, BringsAndPerceivesWhileItPassesAWaypoint) {
  const std::vector<motion::Waypoint> way{GetParam().free_waypoint, GetParam().pick.front(), GetParam().free_waypoint};
  int calls = 0;
  const Feedback start = plant_->read();
  double seen_at = 0.0;
  const Feedback there =
      plant_->submit({GetParam().item, way, {}}, {0, [&] {
                                                    ++calls;
                                                    EXPECT_TRUE(plant_->bring(GetParam().item));
                                                    const perception::Observation seen = plant_->perceive(item_alone());
                                                    seen_at = seen.time;
                                                    EXPECT_NE(perception::find(seen, GetParam().item), nullptr);
                                                  }});
  EXPECT_EQ(there.end.reason, EndReason::Completed) << describe(there.end, way);
  EXPECT_EQ(there.end.waypoint, 2);
  EXPECT_EQ(calls, 1);
  EXPECT_GT(seen_at, start.time);
  EXPECT_LT(seen_at, there.time) << "it moves on";
  EXPECT_FALSE(plant_->bring(GetParam().item)) << "it has come";
  double sum = 0.0;
  for (const WaypointTime& one : there.times) sum += one.moving + one.waiting;
  EXPECT_NEAR(sum, there.time - start.time, 1e-9) << "rounding of sums";
}

TEST_P(PlantContract, WhatIsToBeDoneOnPassingIsNotDoneBeforeOrInVain) {
  int calls = 0;
  const auto passing = [&](int waypoint) { return OnPassing{waypoint, [&calls] { ++calls; }}; };
  const motion::Waypoint& free = GetParam().free_waypoint;
  motion::Waypoint sucking = free;
  sucking.io.vacuum = true;
  EXPECT_EQ(plant_->submit({GetParam().item, {}, {}}, passing(0)).end.reason, EndReason::Refused);
  EXPECT_EQ(plant_->submit({GetParam().item, {free, sucking, free}, {}}, passing(1)).end.reason, EndReason::NoSeal);
  EXPECT_EQ(plant_->submit({GetParam().item, {free, free}, {}}, passing(1)).end.reason, EndReason::Completed);
  EXPECT_EQ(calls, 0) << "refused, ended before, and the last waypoint, which is not passed";
}

TEST_P(PlantContract, StopsAtAForce) {
  ASSERT_TRUE(plant_->bring(GetParam().item));
  const double limit = 10.0;
  const Feedback fed = go({GetParam().free_waypoint, GetParam().pressing}, {limit, false});
  EXPECT_EQ(fed.end.reason, EndReason::ForceGuard);
  EXPECT_EQ(fed.end.waypoint, 1);
  EXPECT_GT(fed.end.value, limit);
  EXPECT_EQ(fed.end.limit, limit);
  EXPECT_EQ(fed.V_WE.linear.norm(), 0.0);
}

TEST_P(PlantContract, AcknowledgingNothingIsHarmless) {
  plant_->acknowledge();
  EXPECT_EQ(go({GetParam().free_waypoint}).end.reason, EndReason::Completed);
}

TEST_P(PlantContract, TheSameCallsGiveTheSameAnswers) {
  const std::unique_ptr<Plant> other = GetParam().make();
  for (Plant* plant : {plant_.get(), other.get()}) {
    EXPECT_TRUE(plant->bring(GetParam().item));
    (void)plant->submit({GetParam().item, GetParam().pick, {}});
  }
  EXPECT_EQ(plant_->read(), other->read());
  EXPECT_EQ(plant_->perceive(item_alone()), other->perceive(item_alone()));
}

}  // namespace snug::plant
