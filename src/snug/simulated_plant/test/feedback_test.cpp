// Feedback of a simulated plant against closed forms: weight, vacuum, time, peaks, guards; the same calls, the same
// bytes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/core/input_error.hpp"
#include "snug/simulated_plant/test/demo_rows.hpp"

namespace snug::simulated_plant {
namespace {

using namespace test;
using plant::EndReason;

/// Motions end two seconds after the tool stands: boxes hang still.
model::Scenario unhurried() {
  model::Scenario scenario = three_boxes();
  scenario.motion_guards.exact_settle = scenario.motion_guards.longest_settle = 2.0;
  return scenario;
}

SimulatedPlantOptions drawn(std::uint64_t seed, std::string_view robot = {}) {
  SimulatedPlantOptions options;
  options.seed = seed;
  options.simulation.robot = robot;
  return options;
}

const physics::BodyState& body_of(const SimulatedPlant& plant, std::size_t item) {
  return plant.state().world.bodies[static_cast<std::size_t>(plant.simulation().world().parcels[item].index)];
}

/// m g down, and its moment about the gripper's end: with the tool alone and on the arm, of boxes of any mass and
/// centre of mass.
TEST(Feedback, OfABoxThatHangsStillIsItsWeight) {
  for (const char* robot : {"", "ur10"}) {
    for (const std::uint64_t seed : {0UL, 3UL}) {
      SCOPED_TRACE(std::string(robot) + " " + std::to_string(seed));
      SimulatedPlant plant(unhurried(), "1", drawn(seed, robot));
      ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
      const plant::Feedback held = plant::run(plant, pick_of("BOX027"));
      ASSERT_EQ(held.end.reason, EndReason::Completed);
      ASSERT_LT(body_of(plant, 0).velocity.norm(), 1e-3);
      const double mass = model::find_parcel(plant.simulation().scenario(), "BOX027")->inertia.mass;
      const Vector3 weight(0.0, 0.0, -9.81 * mass);
      const Vector3 force_W = held.X_WE.R * held.F_E.force, torque_W = held.X_WE.R * held.F_E.torque;
      // 1e-3 m/s of a swing of a fifth of a second are 0.03 m/s^2: a third of a percent.
      EXPECT_LT((force_W - weight).norm(), 0.004 * weight.norm());
      const Vector3 moment = (body_of(plant, 0).p_WBcm - held.X_WE.p).cross(weight);
      EXPECT_LT((torque_W - moment).norm(), 0.004 * weight.norm() * 0.2);
    }
  }
}

/// Newton's law over the whole way up: what the cup did to the box is its change of momentum and what gravity took.
TEST(Feedback, ForcesOverTheWholeWayAreTheMomentumOfTheBox) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  ASSERT_EQ(plant::run(plant, pick_of("BOX027")).end.reason, EndReason::Completed);
  const double mass = model::find_parcel(three_boxes(), "BOX027")->inertia.mass;
  const Vector3 before = mass * body_of(plant, 0).velocity;
  Vector3 impulse = Vector3::Zero(), last = plant.read().X_WE.R * plant.read().F_E.force;
  const double start = plant.read().time, tick = three_boxes().controller.tick;
  const auto look = [&](const cell::CellTick& one) {
    const Vector3 now = one.tool.X_WE.R * plant.simulation().tool_load(plant.state(), plant.work()).force;
    impulse -= 0.5 * tick * (last + now);  // on the box; by the trapezoidal rule
    last = now;
  };
  motion::Waypoint far = pick_of("BOX027").waypoints.back();
  far.motion_class = motion::MotionClass::PrePlace;
  far.X_WE.p += Vector3(0.4, -0.2, 0.1);
  ASSERT_EQ(run_seen(plant, {model::ParcelId("BOX027"), {far}}, look).end.reason, EndReason::Completed);
  const double seconds = plant.read().time - start;
  const Vector3 gained = mass * body_of(plant, 0).velocity - before + 9.81 * mass * seconds * Vector3::UnitZ();
  EXPECT_GT(gained.norm(), 5.0) << "N s";
  EXPECT_LT((impulse - gained).norm(), 0.01 * gained.norm());
}

TEST(Feedback, OfAnEmptyCupInTheAirIsNothing) {
  for (const char* robot : {"", "ur10"}) {
    SimulatedPlant plant(three_boxes(), "1", drawn(0, robot));
    motion::Waypoint there = packing_of("BOX027").waypoints.front();
    there.X_WE.p.z() += 0.2;
    const plant::Feedback fed = plant::run(plant, {{}, {there}, {}});
    ASSERT_EQ(fed.end.reason, EndReason::Completed);
    EXPECT_LT(fed.F_E.force.norm(), 1e-9);
    EXPECT_LT(fed.peak_force, 1e-9);
    EXPECT_EQ(fed.pressure_gauge, 0.0);
  }
}

TEST(Feedback, TheVacuumBuildsUpUnderASealAndNotInTheAir) {
  const model::CupParams& cup = three_boxes().cup;
  SimulatedPlant plant(three_boxes(), "1", nominal());
  const plant::Motion pick = pick_of("BOX027");
  motion::Waypoint in_air = pick.waypoints.front();
  in_air.io.vacuum = true;
  plant::Feedback fed = plant::run(plant, {{}, {pick.waypoints.front(), in_air}, {std::nullopt, false}});
  EXPECT_EQ(fed.end.reason, EndReason::Completed);
  EXPECT_EQ(fed.pressure_gauge, 0.0);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  double last = 0.0;
  std::vector<double> rises;
  const auto look = [&](const cell::CellTick& tick) {
    const double now = plant.state().gripper.cup.pressure_gauge;
    EXPECT_GE(now, cup.vacuum.pressure_gauge_hold - 3000.0) << "a cup that is stretched has a little more";
    EXPECT_LE(now, cup.vacuum.pressure_gauge_blow + 1e-9);
    if (tick.command.vacuum && now < last) rises.push_back(now);
    last = now;
  };
  fed = run_seen(plant, pick, look);
  ASSERT_EQ(fed.end.reason, EndReason::Completed);
  EXPECT_GT(rises.size(), 10U);
  EXPECT_NEAR(fed.pressure_gauge, cup.vacuum.pressure_gauge_hold, 0.05 * std::abs(cup.vacuum.pressure_gauge_hold));
}

TEST(Feedback, TimeIsCountedInTicksAndNeverRunsBack) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  const double tick = three_boxes().controller.tick;
  double last = plant.read().time;
  EXPECT_EQ(last, 0.0);
  const auto look = [&](const cell::CellTick&) {
    const double now = plant.simulation().time(plant.state());
    EXPECT_NEAR(now - last, tick, 1e-12);
    last = now;
  };
  const plant::Feedback fed = pack(plant, "BOX027", look);
  EXPECT_EQ(fed.time, last);
  double sum = 0.0;
  ASSERT_EQ(fed.times.size(), packing_of("BOX027").waypoints.size());
  for (const plant::WaypointTime& one : fed.times) {
    EXPECT_GE(one.moving, 0.0);
    EXPECT_GE(one.waiting, 0.0);
    sum += one.moving + one.waiting;
  }
  EXPECT_NEAR(sum, fed.time, 1e-9) << "nothing lost";
  (void)plant::bring_and_wait(plant, model::ParcelId("BOX028"));
  (void)plant::observe(plant, {});
  plant.acknowledge();
  EXPECT_EQ(plant.read().time, fed.time) << "it stands still between motions";
}

TEST(Feedback, PeaksAreOfTheLastMotionAndAtLeastWhatIsThereInTheEnd) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Motion pick = pick_of("BOX027");
  const plant::Feedback held = plant::run(plant, pick);
  EXPECT_GT(held.peak_force, 1.5 * held.F_E.force.norm()) << "it was pressed when it was picked";
  const plant::Feedback still = plant::run(plant, {model::ParcelId("BOX027"), {pick.waypoints.back()}, {}});
  EXPECT_LT(still.peak_force, 1.2 * held.F_E.force.norm()) << "not what was before";
  EXPECT_GE(still.peak_force, still.F_E.force.norm());
  EXPECT_GE(still.peak_torque, still.F_E.torque.norm());
  const plant::Feedback refused = plant::run(plant, {model::ParcelId("BOX027"), {}, {}});
  EXPECT_GE(refused.peak_force, refused.F_E.force.norm()) << "it hangs there all the same";
}

TEST(Feedback, AGuardOfTheHoldEndsAMotionThatTheCupCouldStillBear) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  plant::Motion motion = pick_of("BOX027");
  motion.guards.hold_factor = 1000.0;
  const plant::Feedback fed = plant::run(plant, motion);
  EXPECT_EQ(fed.end.reason, EndReason::HoldGuard);
  EXPECT_EQ(fed.end.limit, 1000.0);
  EXPECT_LT(fed.end.value, 1000.0);
  EXPECT_GT(fed.end.value, 1.0);
  EXPECT_EQ(fed.V_WE.linear.norm(), 0.0);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Held);
}

TEST(Feedback, AWaypointThatIsNotReachedInTimeEndsTheMotion) {
  model::Scenario scenario = three_boxes();
  scenario.motion_guards.waypoint_patience = 0.2;
  SimulatedPlant plant(scenario, "1", nominal());
  const plant::Feedback fed = plant::run(plant, {{}, {packing_of("BOX027").waypoints.front()}, {}});
  EXPECT_EQ(fed.end.reason, EndReason::Timeout);
  EXPECT_EQ(fed.end.waypoint, motion::WaypointIndex(0));
  EXPECT_EQ(fed.end.limit, 0.2);
  EXPECT_NEAR(fed.time, 0.2, 2.0 * scenario.controller.tick);
  EXPECT_EQ(fed.V_WE.linear.norm(), 0.0);
}

TEST(Feedback, AWaypointFarBeyondTheCellIsNoReasonToHangOrToLoseTheTool) {
  for (const char* robot : {"", "ur10"}) {
    SCOPED_TRACE(robot);
    SimulatedPlant plant(three_boxes(), "1", drawn(0, robot));
    motion::Waypoint far = packing_of("BOX027").waypoints.front();
    far.X_WE.p.x() = 1e3;
    const plant::Feedback fed = plant::run(plant, {{}, {far}, {}});
    EXPECT_TRUE(fed.X_WE.p.allFinite());
    if (robot[0] != '\0') {
      EXPECT_NE(fed.end.reason, EndReason::Completed);
      EXPECT_LT(fed.X_WE.p.norm(), 2.0) << "as far as an arm reaches";
    }
    EXPECT_LE(fed.time, three_boxes().motion_guards.waypoint_patience + 3.0);
  }
}

TEST(Feedback, BadMotionsAreRefusedAndChangeNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SimulatedPlant plant(three_boxes(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const std::uint64_t before = plant.simulation().hash(plant.state());
  plant::Motion motion = pick_of("BOX027");
  for (std::size_t row = 0; row < motion.waypoints.size(); ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      plant::Motion bad = motion;
      bad.waypoints[row].X_WE.p[axis] = nan;
      EXPECT_EQ(plant::run(plant, bad).end.reason, EndReason::Refused);
      bad = motion;
      bad.waypoints[row].X_WE.R(axis, 0) = -std::numeric_limits<double>::infinity();
      const plant::Feedback fed = plant::run(plant, bad);
      EXPECT_EQ(fed.end.reason, EndReason::Refused);
      EXPECT_FALSE(fed.end.where.empty()) << "says why";
      EXPECT_TRUE(fed.times.empty());
    }
  }
  EXPECT_EQ(plant::run(plant, {model::ParcelId("BOX027"), {}, {}}).end.reason, EndReason::Refused);
  EXPECT_EQ(plant.simulation().hash(plant.state()), before);
  EXPECT_EQ(plant::run(plant, motion).end.reason, EndReason::Completed) << "and a good one goes on";
}

/// A box of a mass that no number holds any more.
TEST(Feedback, APlantThatFailsSaysSoAndMovesNoMore) {
  model::Scenario scenario = three_boxes();
  std::ranges::find(scenario.parcels, "BOX027", &model::Parcel::id)->inertia.mass = 1e308;
  SimulatedPlant plant(scenario, "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Feedback failed = plant::run(plant, pick_of("BOX027"));
  EXPECT_EQ(failed.end.reason, EndReason::Fault);
  EXPECT_FALSE(failed.end.where.empty());
  EXPECT_TRUE(failed.X_WE.p.allFinite());
  plant.acknowledge();
  const plant::Feedback refused = plant::run(plant, {{}, {packing_of("BOX028").waypoints.front()}, {}});
  EXPECT_EQ(refused.end.reason, EndReason::Refused);
  EXPECT_EQ(refused.end.where, "the plant has failed");
  EXPECT_EQ(refused.X_WE, failed.X_WE);
}

TEST(SimulatedPlantCalls, TheSameOnesGiveTheSameBytesWhateverIsReadInBetween) {
  for (const char* faults : {"", "displace@1,drop@2,object@1"}) {
    SimulatedPlantOptions options = nominal(faults);
    options.seed = 11;
    SimulatedPlant one(three_boxes(), "1", options), other(three_boxes(), "1", options);
    for (const std::string_view item : kItems) {
      const plant::Feedback a = pack(one, item);
      for (int look = 0; look < 3; ++look) (void)plant::observe(other, {});
      (void)other.read();
      (void)other.describe();
      (void)plant::bring_and_wait(other, model::ParcelId("BOX999"));
      EXPECT_EQ(a, pack(other, item)) << item;
      EXPECT_EQ(one.simulation().hash(one.state()), other.simulation().hash(other.state())) << item;
    }
  }
}

TEST(SimulatedPlantCalls, OtherSeedsAreOtherPlantsAndTheirNamesSayWhich) {
  SimulatedPlant exact(three_boxes(), "1", drawn(0)), one(three_boxes(), "1", drawn(1)),
      two(three_boxes(), "1", drawn(2));
  EXPECT_EQ(exact.describe().name, "simulated, as the scenario says");
  EXPECT_EQ(one.describe().name, "simulated, plant seed 1");
  for (SimulatedPlant* plant : {&exact, &one, &two})
    ASSERT_TRUE(plant::bring_and_wait(*plant, model::ParcelId("BOX027")));
  EXPECT_NE(pose_of(one, "BOX027").p, pose_of(two, "BOX027").p);
  EXPECT_NE(pose_of(one, "BOX027").p, pose_of(exact, "BOX027").p);
  EXPECT_LT((pose_of(one, "BOX027").p - pose_of(exact, "BOX027").p).norm(), 0.01) << "at the same aligner";
}

TEST(SimulatedPlantCalls, UnknownSequencesAndRobotsAreErrors) {
  EXPECT_THROW(SimulatedPlant(three_boxes(), "nine", nominal()), InputError);
  EXPECT_THROW(SimulatedPlant(three_boxes(), "1", drawn(1, "no such robot")), InputError);
}

TEST(Bring, TakesAwayWhatStoodThereAndNotWhatHangsFromTheCup) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX028")));
  EXPECT_EQ(perception::find(plant::observe(plant, {}), "BOX027"), nullptr);
  EXPECT_NE(perception::find(plant::observe(plant, {}), "BOX028"), nullptr);
  ASSERT_EQ(plant::run(plant, pick_of("BOX028")).end.reason, EndReason::Completed);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX013")));
  EXPECT_NE(perception::find(plant::observe(plant, {}), "BOX028"), nullptr);
  EXPECT_NE(perception::find(plant::observe(plant, {}), "BOX013"), nullptr);
  EXPECT_FALSE(plant::bring_and_wait(plant, model::ParcelId("BOX027"))) << "it came before";
}

TEST(MotionTruth, CountsFromWhenAnItemIsBrought) {
  SimulatedPlant plant(three_boxes(), "1", nominal());
  EXPECT_EQ(plant.motion_truth(), MotionTruth{});
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
  const MotionTruth first = plant.motion_truth();
  EXPECT_GT(first.hold_factor, 1.0) << "it did not fall";
  EXPECT_TRUE(std::isfinite(first.hold_factor));
  EXPECT_GE(first.swing, 0.0);
  EXPECT_LT(first.swing, 0.02);
  EXPECT_EQ(first.joint_speed, 0.0) << "no joints";
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX028")));
  EXPECT_EQ(plant.motion_truth(), MotionTruth{});
}

TEST(MotionTruth, OfAnArmItsJointsMoveWithinWhatTheyMay) {
  SimulatedPlant plant(three_boxes(), "1", drawn(0, "ur10"));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
  EXPECT_GT(plant.motion_truth().joint_speed, 0.3);
  EXPECT_LE(plant.motion_truth().joint_speed, 1.001);
  EXPECT_GT(plant.motion_truth().joint_acceleration, 0.1);
  EXPECT_LE(plant.motion_truth().joint_acceleration, 1.05);
}

/// The largest load of a lift by a rigid hold is m (g + a): the factor of the way is below that of hanging still.
TEST(MotionTruth, TheHoldIsLeastWhereTheBoxIsAccelerated) {
  SimulatedPlant plant(unhurried(), "1", nominal());
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Feedback held = plant::run(plant, pick_of("BOX027"));
  ASSERT_EQ(held.end.reason, EndReason::Completed);
  const double still = cup::sensed_hold_factor(plant.simulation().scenario().cup, held.pressure_gauge, held.F_E);
  EXPECT_LT(plant.motion_truth().hold_factor, still);
  EXPECT_GT(plant.motion_truth().hold_factor, 0.2 * still);
}

}  // namespace
}  // namespace snug::simulated_plant
