// PlantContract: what every Plant promises, run on any implementation: include, instantiate with a way to make one.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
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
#include "snug/plant/wait.hpp"

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
    return run(*plant_, motion_of(std::move(waypoints), guards));
  }
  [[nodiscard]] static Motion motion_of(std::vector<motion::Waypoint> waypoints, Guards guards = {}) {
    return {item(), std::move(waypoints), guards, {}};
  }
  [[nodiscard]] static model::ParcelId item() { return model::ParcelId(GetParam().item); }
  [[nodiscard]] static bool is_there(const perception::Observation& seen) {
    return perception::find(seen, GetParam().item) != nullptr;
  }
  [[nodiscard]] static std::vector<motion::Waypoint> there_and_back() {
    return {GetParam().free_waypoint, GetParam().pick.front(), GetParam().free_waypoint};
  }
  /// Advances until the motion has ended, at most `most` times; all events.
  std::vector<Event> finish(int most = 1'000'000) {
    std::vector<Event> all;
    while (plant_->is_moving() && most-- > 0) {
      for (Event& event : plant_->advance()) all.push_back(std::move(event));
    }
    for (Event& event : plant_->advance()) all.push_back(std::move(event));
    return all;
  }
  template <class Kind>
  [[nodiscard]] static std::vector<Kind> all_of(const std::vector<Event>& events) {
    std::vector<Kind> found;
    for (const Event& event : events) {
      if (const Kind* one = get<Kind>(event)) found.push_back(*one);
    }
    return found;
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
  EXPECT_FALSE(plant_->bring(model::ParcelId("no such item")));
  EXPECT_FALSE(plant_->bring({}));
  EXPECT_TRUE(bring_and_wait(*plant_, item()));
  EXPECT_FALSE(plant_->bring(item()));
}

TEST_P(PlantContract, EveryExpectedItemIsEitherSeenOrNot) {
  std::vector<perception::Expectation> expected = item_alone();
  expected.push_back({"no such item", Vector3::Constant(0.1), std::nullopt});
  for (const bool is_there : {false, true}) {
    if (is_there) {
      EXPECT_TRUE(bring_and_wait(*plant_, item()));
    }
    const perception::Observation seen = observe(*plant_, expected);
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
  EXPECT_EQ(there.end.waypoint, motion::WaypointIndex(0));
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
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  const Feedback held = go(GetParam().pick);
  ASSERT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, GetParam().pick);
  EXPECT_LT(held.pressure_gauge, -1.0e4);
  EXPECT_TRUE(held.io.vacuum);
  EXPECT_GT(held.F_E.force.norm(), 0.5) << "N";
  EXPECT_GE(held.peak_force, held.F_E.force.norm());
}

TEST_P(PlantContract, WithoutAMotionNothingHappensAndNoTimePasses) {
  const Feedback before = plant_->read();
  EXPECT_FALSE(plant_->is_moving());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(plant_->advance().empty());
  plant_->cancel();
  EXPECT_TRUE(plant_->advance().empty());
  EXPECT_EQ(plant_->read(), before);
}

TEST_P(PlantContract, EventsComeInTheOrderOfTimeAndEachOnce) {
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  std::vector<motion::Waypoint> waypoints = GetParam().pick;
  waypoints.insert(waypoints.begin(), GetParam().free_waypoint);
  plant_->start(motion_of(waypoints));
  EXPECT_TRUE(plant_->is_moving());
  const std::vector<Event> events = finish();
  EXPECT_FALSE(plant_->is_moving());
  EXPECT_TRUE(plant_->advance().empty());
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::time));
  const auto passed = all_of<WaypointPassed>(events);
  ASSERT_EQ(passed.size(), waypoints.size() - 1) << "the last one is reached, not passed";
  for (std::size_t i = 0; i < passed.size(); ++i) EXPECT_EQ(passed[i].waypoint.slot(), i);
  EXPECT_EQ(all_of<VacuumBuilt>(events).size(), 1U);
  EXPECT_TRUE(all_of<VacuumDropped>(events).empty());
  EXPECT_TRUE(all_of<GuardTripped>(events).empty());
  EXPECT_TRUE(all_of<FaultRaised>(events).empty());
  const auto ended = all_of<MotionEnded>(events);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_NE(get<MotionEnded>(events.back()), nullptr);
  EXPECT_EQ(ended[0].feedback.end.reason, EndReason::Completed);
  EXPECT_EQ(ended[0].feedback, plant_->read());
}

TEST_P(PlantContract, AHeldBoxIsNoNewVacuum) {
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  ASSERT_EQ(go(GetParam().pick).end.reason, EndReason::Completed);
  plant_->start(motion_of({GetParam().pick.back()}));
  EXPECT_TRUE(all_of<VacuumBuilt>(finish()).empty());
}

TEST_P(PlantContract, ReadsWhileItMoves) {
  plant_->start(motion_of({GetParam().free_waypoint}));
  double before = plant_->read().time;
  int ticks = 0;
  while (plant_->is_moving()) {
    (void)plant_->advance();
    const Feedback now = plant_->read();
    EXPECT_EQ(now, plant_->read());
    EXPECT_GE(now.time, before);
    before = now.time;
    ++ticks;
  }
  EXPECT_GT(ticks, 1);
}

TEST_P(PlantContract, BringsAndPerceivesWhileItPassesAWaypoint) {
  plant_->start(motion_of(there_and_back()));
  const double start = plant_->read().time;
  double seen_at = 0.0;
  bool has_arrived = false;
  Feedback there;
  while (plant_->is_moving()) {
    for (const Event& event : plant_->advance()) {
      if (const auto* passed = get<WaypointPassed>(event); passed != nullptr && passed->waypoint.value == 0) {
        EXPECT_TRUE(plant_->bring(item()));
        EXPECT_FALSE(plant_->bring(item())) << "it comes already";
      }
      if (const auto* arrived = get<ItemArrived>(event)) {
        EXPECT_EQ(arrived->item, item());
        has_arrived = true;
        plant_->perceive(item_alone());
      }
      if (const auto* seen = get<Perceived>(event)) {
        EXPECT_TRUE(is_there(seen->observation));
        EXPECT_EQ(seen->observation.time, event.time);
        seen_at = event.time;
      }
      if (const auto* ended = get<MotionEnded>(event)) there = ended->feedback;
    }
  }
  EXPECT_TRUE(has_arrived);
  EXPECT_EQ(there.end.reason, EndReason::Completed) << describe(there.end, there_and_back());
  EXPECT_EQ(there.end.waypoint, motion::WaypointIndex(2));
  EXPECT_GT(seen_at, start);
  EXPECT_LT(seen_at, there.time) << "it moves on";
  double sum = 0.0;
  for (const WaypointTime& one : there.times) sum += one.moving + one.waiting;
  EXPECT_NEAR(sum, there.time - start, 1e-9) << "rounding of sums";
}

TEST_P(PlantContract, PerceivingTakesNoTickOfAMotionAndEachIsAnswered) {
  plant_->start(motion_of(there_and_back()));
  for (int i = 0; i < 3; ++i) (void)plant_->advance();
  const double now = plant_->read().time;
  for (int i = 0; i < 3; ++i) plant_->perceive(item_alone());
  std::vector<Event> events;
  while (all_of<Perceived>(events).size() < 3) {
    for (Event& event : plant_->advance()) events.push_back(std::move(event));
  }
  for (const Perceived& one : all_of<Perceived>(events)) EXPECT_EQ(one.observation.time, now);
  EXPECT_EQ(plant_->read().time, now);
  EXPECT_EQ(all_of<MotionEnded>(finish()).size(), 1U);
}

TEST_P(PlantContract, WhatIsPassedIsNotSaidBeforeOrInVain) {
  const motion::Waypoint& free = GetParam().free_waypoint;
  motion::Waypoint sucking = free;
  sucking.io.vacuum = true;
  const auto passed_of = [&](std::vector<motion::Waypoint> waypoints) {
    plant_->start(motion_of(std::move(waypoints)));
    return all_of<WaypointPassed>(finish());
  };
  EXPECT_TRUE(passed_of({}).empty()) << "refused";
  const auto ended = passed_of({free, sucking, free});
  ASSERT_EQ(ended.size(), 1U) << "it ends on the way to the second";
  EXPECT_EQ(ended[0].waypoint.value, 0);
  EXPECT_EQ(passed_of({free, free}).size(), 1U) << "the last one is not passed";
}

/// Before its first tick, at each of the next, later and later, and while it comes to rest.
TEST_P(PlantContract, CancelsAtEachInstant) {
  int most = 0;
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  for (plant_->start(motion_of(GetParam().pick)); plant_->is_moving(); ++most) (void)plant_->advance();
  std::vector<int> instants = {0, 1, most / 4, most / 2, 3 * most / 4, most - 1};
  for (const int instant : instants) {
    SCOPED_TRACE(instant);
    plant_ = GetParam().make();
    ASSERT_TRUE(bring_and_wait(*plant_, item()));
    plant_->start(motion_of(GetParam().pick));
    for (int i = 0; i < instant; ++i) {
      for (const Event& event : plant_->advance()) ASSERT_EQ(get<MotionEnded>(event), nullptr);
    }
    ASSERT_TRUE(plant_->is_moving());
    plant_->cancel();
    plant_->cancel();
    const auto ended = all_of<MotionEnded>(finish());
    ASSERT_EQ(ended.size(), 1U);
    EXPECT_EQ(ended[0].feedback.end.reason, EndReason::Cancelled);
    EXPECT_EQ(ended[0].feedback.V_WE.linear.norm(), 0.0);
    EXPECT_EQ(go({GetParam().free_waypoint}, {std::nullopt, false}).end.reason, EndReason::Completed);
  }
}

TEST_P(PlantContract, AnItemThatWasBroughtComesThoughTheMotionIsCancelled) {
  plant_->start(motion_of(there_and_back()));
  (void)plant_->advance();
  ASSERT_TRUE(plant_->bring(item()));
  plant_->cancel();
  EXPECT_EQ(all_of<ItemArrived>(finish()).size(), 1U);
  EXPECT_TRUE(is_there(observe(*plant_, item_alone())));
}

TEST_P(PlantContract, StopsAtAForce) {
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  const double limit = 10.0;
  const Feedback fed = go({GetParam().free_waypoint, GetParam().pressing}, {limit, false});
  EXPECT_EQ(fed.end.reason, EndReason::ForceGuard);
  EXPECT_EQ(fed.end.waypoint, motion::WaypointIndex(1));
  EXPECT_GT(fed.end.value, limit);
  EXPECT_EQ(fed.end.limit, limit);
  EXPECT_EQ(fed.V_WE.linear.norm(), 0.0);
}

TEST_P(PlantContract, SaysThatAGuardTrippedBeforeTheMotionEnds) {
  ASSERT_TRUE(bring_and_wait(*plant_, item()));
  plant_->start(motion_of({GetParam().free_waypoint, GetParam().pressing}, {10.0, false}));
  const std::vector<Event> events = finish();
  const auto tripped = all_of<GuardTripped>(events);
  const auto ended = all_of<MotionEnded>(events);
  ASSERT_EQ(tripped.size(), 1U);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(tripped[0].end, ended[0].feedback.end);
  EXPECT_NE(get<MotionEnded>(events.back()), nullptr);
}

TEST_P(PlantContract, AcknowledgingNothingIsHarmless) {
  plant_->acknowledge();
  EXPECT_EQ(go({GetParam().free_waypoint}).end.reason, EndReason::Completed);
}

TEST_P(PlantContract, TheSameCallsGiveTheSameAnswers) {
  const std::unique_ptr<Plant> other = GetParam().make();
  for (Plant* plant : {plant_.get(), other.get()}) {
    EXPECT_TRUE(bring_and_wait(*plant, item()));
    (void)run(*plant, motion_of(GetParam().pick));
  }
  EXPECT_EQ(plant_->read(), other->read());
  EXPECT_EQ(observe(*plant_, item_alone()), observe(*other, item_alone()));
}

}  // namespace snug::plant
