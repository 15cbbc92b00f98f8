// Faults in a plant: each happens to the item that it names, once, and changes nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/simulated_plant/test/demo_rows.hpp"

namespace snug::simulated_plant {
namespace {

using namespace test;
using plant::EndReason;

/// A plant after all three items were brought and packed.
std::unique_ptr<SimulatedPlant> packed_with(std::string_view faults) {
  auto plant = std::make_unique<SimulatedPlant>(three_boxes(), "1", nominal(faults));
  for (const std::string_view item : kItems) (void)pack(*plant, item);
  return plant;
}

/// Of the plant in which nothing goes wrong.
const SimulatedPlant& sound() {
  static const std::unique_ptr<SimulatedPlant> one = packed_with("");
  return *one;
}

double off_by(const SimulatedPlant& plant, std::string_view item) {
  return (pose_of(plant, item).p - pose_of(sound(), item).p).norm();
}

/// m: a box beside one that was moved is at most touched.
constexpr double kSamePlace = 0.003;

TEST(FaultInjection, WithoutFaultsBoxesAreWhereTheyWerePut) {
  const Pose X_WT = model::find_container(three_boxes(), "tote1")->X_WT;
  const std::map<std::string_view, Vector3> meant{{"BOX027", {-0.0930, -0.1655, 0.0470}},
                                                  {"BOX028", {0.0930, -0.1655, 0.0470}},
                                                  {"BOX013", {-0.0815, 0.0770, 0.0485}}};
  for (const auto& [item, p_TP] : meant) EXPECT_LT((pose_of(sound(), item).p - X_WT * p_TP).norm(), 1e-3) << item;
  EXPECT_TRUE(fault_events(sound()).empty());
  for (const cell::BoxResult& box : sound().boxes()) EXPECT_EQ(box.state, cell::BoxState::Packed) << box.id;
}

TEST(FaultInjection, OfAnItemThatNeverComesChangeNoByte) {
  const auto plant = packed_with("noseal@4,drop@5,stop@6,displace@7,push@8");
  EXPECT_EQ(plant->simulation().hash(plant->state()), sound().simulation().hash(sound().state()));
  EXPECT_TRUE(fault_events(*plant).empty());
}

TEST(FaultInjection, DisplaceMovesTheItemThatWasLetGoByThirtyMillimetresAndNoOther) {
  const auto plant = packed_with("displace@2");
  EXPECT_NEAR(off_by(*plant, "BOX028"), 0.030, kSamePlace);
  EXPECT_LT(off_by(*plant, "BOX027"), kSamePlace);
  EXPECT_LT(off_by(*plant, "BOX013"), kSamePlace);
  ASSERT_EQ(fault_events(*plant).size(), 1U);
  EXPECT_EQ(fault_events(*plant)[0].body, "BOX028");
  EXPECT_EQ(fault_events(*plant)[0].text, "displace: moved 30 mm aside and lifted 0 mm");
}

TEST(FaultInjection, PushMovesThePackedBoxThatIsNearestAndNotTheItem) {
  const auto plant = packed_with("push@2");
  EXPECT_NEAR(off_by(*plant, "BOX027"), 0.030, 2.0 * kSamePlace) << "the third item may touch it";
  EXPECT_LT(off_by(*plant, "BOX028"), kSamePlace);
  EXPECT_LT(off_by(*plant, "BOX013"), kSamePlace);
  ASSERT_EQ(fault_events(*plant).size(), 1U);
  EXPECT_EQ(fault_events(*plant)[0].body, "BOX027");
  const auto third = packed_with("push@3");
  ASSERT_EQ(fault_events(*third).size(), 1U);
  EXPECT_EQ(fault_events(*third)[0].body, "BOX027") << "0.24 m from the third item, BOX028 0.30 m";
}

TEST(FaultInjection, PushDoesNothingWhereNothingIsPackedAndIsNotKeptForLater) {
  const auto plant = packed_with("push@1");
  EXPECT_TRUE(fault_events(*plant).empty());
  for (const std::string_view item : kItems) EXPECT_EQ(off_by(*plant, item), 0.0) << item;
}

TEST(FaultInjection, PushMovesNoBoxThatIsNotPacked) {
  SimulatedPlant plant(three_boxes(), "1", nominal("noseal@1,push@2"));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::NoSeal);  // taken away by the next arrival
  ASSERT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed);
  ASSERT_EQ(fault_events(plant).size(), 1U);
  EXPECT_EQ(fault_events(plant)[0].text, "noseal: the lip leaks");
}

/// m, along the face normal of either along which two boxes share least; below 0: they are apart. An item that is set
/// down on a box that was moved may lean on it.
double shared(const SimulatedPlant& plant, std::string_view a, std::string_view b) {
  const auto half = [&](std::string_view item) {
    const model::Parcel& parcel = *model::find_parcel(three_boxes(), std::string(item));
    return Vector3(0.5 * model::collision_size(three_boxes(), parcel));
  };
  const Pose X_WA = pose_of(plant, a), X_WB = pose_of(plant, b);
  double least = std::numeric_limits<double>::infinity();
  for (const Matrix3& R : {X_WA.R, X_WB.R}) {
    const Vector3 reach = (R.transpose() * X_WA.R).cwiseAbs() * half(a) + (R.transpose() * X_WB.R).cwiseAbs() * half(b);
    least = std::min(least, (reach - (R.transpose() * (X_WA.p - X_WB.p)).cwiseAbs()).minCoeff());
  }
  return least;
}

TEST(FaultInjection, AMovedBoxIsInNoOtherBoxAndInNoWall) {
  for (const char* faults : {"displace@1", "displace@3", "push@2", "push@3"}) {
    SCOPED_TRACE(faults);
    const auto plant = packed_with(faults);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      EXPECT_LT(shared(*plant, kItems[a], kItems[b]), kSamePlace) << kItems[a] << ", " << kItems[b];
    }
    for (const cell::BoxResult& box : plant->boxes()) EXPECT_LT(box.outside, kSamePlace) << box.id;
  }
}

TEST(FaultInjection, CountsItemsAsTheyAreBroughtAndNotByTheSequence) {
  SimulatedPlant plant(three_boxes(), "1", nominal("noseal@1"));
  EXPECT_FALSE(plant::bring_and_wait(plant, model::ParcelId("BOX999"))) << "it does not count";
  EXPECT_EQ(pack(plant, "BOX013").end.reason, EndReason::NoSeal);
  EXPECT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
}

TEST(FaultInjection, ADropHappensOnTheWayBeyondThirtyCentimetresFromTheAligner) {
  SimulatedPlant plant(three_boxes(), "1", nominal("drop@1"));
  const Vector3 p_A = three_boxes().aligner->X_WA.p;
  double before = 0.0, now = 0.0;
  const auto look = [&](const cell::CellTick& tick) {
    before = now;
    now = (tick.tool.X_WE.p - p_A).head<2>().norm();
  };
  const plant::Feedback dropped = pack(plant, "BOX027", look);
  EXPECT_EQ(dropped.end.reason, EndReason::VacuumLost);
  EXPECT_GT(now, 0.30);
  EXPECT_LE(before, 0.30) << "at the first tick there";
  EXPECT_EQ(dropped.pressure_gauge, 0.0);
  ASSERT_EQ(fault_events(plant).size(), 1U);
  EXPECT_NEAR(fault_events(plant)[0].time, dropped.time, 1e-9);
}

/// The cup grows when it leaks and pushes the box off; from then on gravity alone acts, until it meets the bench.
TEST(FaultInjection, ADroppedBoxFallsFreelyOnceTheCupIsOffIt) {
  SimulatedPlant plant(three_boxes(), "1", nominal("drop@1"));
  const plant::Feedback dropped = pack(plant, "BOX027");
  ASSERT_EQ(dropped.end.reason, EndReason::VacuumLost);
  const auto velocity = [&] {
    const int body = plant.simulation().world().parcels[0].index;
    return plant.state().world.bodies[static_cast<std::size_t>(body)].velocity;
  };
  motion::Waypoint up = motion::make_waypoint(motion::MotionClass::PostPlace, "BOX027", dropped.X_WE);
  up.X_WE.p.z() += 0.3;
  const double tick = three_boxes().controller.tick;
  Vector3 before = velocity();
  EXPECT_GT(before.norm(), 0.1) << "it was carried";
  int falling = 0;
  bool was_free = false, has_landed = false;
  const auto look = [&](const cell::CellTick&) {
    const bool is_pushed = !plant.work().gripper.uses.empty(), touches = !plant.work().physics.contacts().empty();
    has_landed = has_landed || (was_free && touches);
    const bool is_free = !is_pushed && !touches && !has_landed;
    if (is_free && was_free) {
      ++falling;
      EXPECT_LT((velocity() - before + 9.81 * tick * Vector3::UnitZ()).norm(), 1e-9);
    }
    was_free = is_free;
    before = velocity();
  };
  (void)run_seen(plant, {model::ParcelId("BOX027"), {up}}, look);
  EXPECT_GE(falling, 2);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Dropped);
}

TEST(FaultInjection, AStopHoldsToolAndBoxWhereTheyAre) {
  SimulatedPlant plant(three_boxes(), "1", nominal("stop@1"));
  const plant::Feedback stopped = pack(plant, "BOX027");
  ASSERT_EQ(stopped.end.reason, EndReason::ProtectiveStop);
  EXPECT_EQ(stopped.end.where, "injected");
  EXPECT_EQ(stopped.end.waypoint, motion::WaypointIndex(3));
  EXPECT_EQ(stopped.V_WE.linear.norm(), 0.0);
  EXPECT_TRUE(stopped.io.vacuum);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Held);
  const Pose X_WP = pose_of(plant, "BOX027");
  EXPECT_EQ(plant::run(plant, packing_of("BOX027")).end.reason, EndReason::Refused);
  EXPECT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX028"))) << "that does not move the robot";
  EXPECT_EQ(plant::run(plant, packing_of("BOX028")).end.reason, EndReason::Refused);
  EXPECT_EQ(plant.read().time, stopped.time);
  EXPECT_EQ(plant.read().X_WE, stopped.X_WE);
  EXPECT_EQ(pose_of(plant, "BOX027"), X_WP);
}

TEST(FaultInjection, AnAcknowledgedStopDoesNotComeBack) {
  SimulatedPlant plant(three_boxes(), "1", nominal("stop@1"));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::ProtectiveStop);
  plant.acknowledge();
  plant::Motion rest = packing_of("BOX027");
  rest.waypoints.erase(rest.waypoints.begin(), rest.waypoints.begin() + 3);
  EXPECT_EQ(plant::run(plant, rest).end.reason, EndReason::Completed);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Packed);
  EXPECT_LT(off_by(plant, "BOX027"), kSamePlace);
  EXPECT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed);
  EXPECT_EQ(fault_events(plant).size(), 1U);
}

/// In one motion, the guard off: the vacuum stays on over a second pick, and seals only after it was off.
TEST(FaultInjection, ALipThatLeaksSealsAgainOnlyAfterTheVacuumWasOff) {
  SimulatedPlant plant(three_boxes(), "1", nominal("noseal@1"));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Motion pick = pick_of("BOX027");
  const motion::Waypoint above = pick.waypoints[0], at = pick.waypoints[1];
  motion::Waypoint sucking = at;
  sucking.io.vacuum = true;
  motion::Waypoint sucking_above = above;
  sucking_above.io.vacuum = true;
  const plant::Guards unguarded{std::nullopt, false};
  plant::Feedback fed =
      plant::run(plant, {model::ParcelId("BOX027"), {above, at, sucking, sucking_above, sucking}, unguarded});
  EXPECT_EQ(fed.end.reason, EndReason::Completed);
  EXPECT_EQ(fed.pressure_gauge, 0.0) << "it touches the box, and leaks";
  fed = plant::run(plant, {model::ParcelId("BOX027"), {above, at, sucking, sucking_above}, unguarded});
  EXPECT_LT(fed.pressure_gauge, 0.8 * three_boxes().cup.vacuum.pressure_gauge_hold);
  EXPECT_EQ(plant.boxes()[0].state, cell::BoxState::Held);
}

TEST(FaultInjection, SeveralOfOneItemHappenOneAfterTheOther) {
  SimulatedPlant plant(three_boxes(), "1", nominal("drop@1,noseal@1,stop@1"));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  EXPECT_EQ(plant::run(plant, packing_of("BOX027")).end.reason, EndReason::NoSeal);
  const plant::Feedback second = plant::run(plant, packing_of("BOX027"));
  EXPECT_EQ(second.end.reason, EndReason::ProtectiveStop);
  EXPECT_EQ(second.pressure_gauge, 0.0) << "and it falls";
  EXPECT_EQ(fault_events(plant).size(), 3U);
}

TEST(FaultInjection, OfDrawnPlantsTheSameFaultHappensToTheSameItem) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SimulatedPlantOptions options = nominal("displace@1");
    options.seed = seed;
    SimulatedPlant plant(three_boxes(), "1", options);
    ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
    ASSERT_EQ(fault_events(plant).size(), 1U);
    EXPECT_EQ(fault_events(plant)[0].body, "BOX027");
  }
}

TEST(FaultInjection, BoxesThatAFaultMovedAreAtRestBeforeTheMotionEnds) {
  for (const char* faults : {"displace@3", "push@3", "object@3"}) {
    const auto plant = packed_with(faults);
    for (const auto body : plant->simulation().world().parcels) {
      EXPECT_LT(plant->state().world.bodies[static_cast<std::size_t>(body.index)].velocity.norm(), 0.02) << faults;
    }
  }
}

TEST(FaultInjection, WaitsForBoxesAtMostAsLongAsTheScenarioSays) {
  model::Scenario scenario = three_boxes();
  scenario.motion_guards.longest_settle = 0.15;
  SimulatedPlant hasty(scenario, "1", nominal("push@3"));
  plant::Feedback fed;
  for (const std::string_view item : kItems) fed = pack(hasty, item);
  const double tick = scenario.controller.tick;
  EXPECT_LE(fed.times.back().waiting, 2.0 * (0.15 + tick) + 1e-9) << "the tool, and the boxes";
  SimulatedPlant patient(three_boxes(), "1", nominal("push@3"));
  for (const std::string_view item : kItems) fed = pack(patient, item);
  EXPECT_GT(fed.times.back().waiting, 0.5) << "it fell and rocked";
}

/// The tool is on its way already when the box is moved, and reaches the last waypoint while the plant waits for it.
TEST(FaultInjection, AMotionWhoseWaypointsEndWhileBoxesComeToRestIsComplete) {
  SimulatedPlantOptions options = nominal("push@3");
  options.simulation.tracking = motion::FastTracking{};
  SimulatedPlant plant(three_boxes(), "1", options);
  for (const std::string_view item : {kItems[0], kItems[1]}) (void)pack(plant, item);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId(std::string(kItems[2]))));
  plant::Motion motion = packing_of(kItems[2]);
  const std::size_t release = motion.waypoints.size() - 2;
  motion.perceive_after = motion::WaypointIndex(release);
  motion.waypoints.back().X_WE.p = motion.waypoints[release].X_WE.p + 0.03 * Vector3::UnitZ();
  const plant::Feedback fed = plant::run(plant, motion);
  EXPECT_EQ(fed.end.reason, EndReason::Completed);
  EXPECT_EQ(fault_events(plant).size(), 1U);
  EXPECT_LT((fed.X_WE.p - motion.waypoints.back().X_WE.p).norm(), 0.001);
  EXPECT_LT(fed.times.back().moving + fed.times.back().waiting, 3.0) << "the box falls and rocks meanwhile";
}

// Foreign objects.

TEST(ObjectFault, StandsAtRestOnWhatCarriesItsWeight) {
  SimulatedPlant plant(three_boxes(), "1", nominal("object@1"));
  Vector3 carried = Vector3::Zero();  // before it fell asleep
  const auto look = [&](const cell::CellTick&) {
    Vector3 now = Vector3::Zero();
    for (const physics::ContactReport& contact : plant.work().physics.contacts()) {
      if (contact.b == plant.objects()[0].body) now += contact.force_W;
      if (contact.a == plant.objects()[0].body) now -= contact.force_W;
    }
    if (now.norm() > 0.0) carried = now;
  };
  ASSERT_EQ(pack(plant, "BOX027", look).end.reason, EndReason::Completed);
  motion::Waypoint stay = packing_of("BOX027").waypoints.back();
  stay.X_WE.p.z() += 0.2;
  ASSERT_EQ(run_seen(plant, {model::ParcelId("BOX027"), {stay}}, look).end.reason, EndReason::Completed);
  EXPECT_NEAR(carried.z(), kForeignMass * 9.81, 0.01 * kForeignMass * 9.81);
  EXPECT_LT(carried.head<2>().norm(), 0.01 * kForeignMass * 9.81);
  const ForeignObject& object = plant.objects()[0];
  EXPECT_TRUE(object.is_in);
  EXPECT_TRUE(object.has_rested);
  EXPECT_LT((object.X_TB.p - object.X_TB_put.p).norm(), 1e-3);
  EXPECT_NEAR(object.X_TB.p.z(), 0.5 * kForeignSize.z(), 1e-3) << "on the floor";
  EXPECT_EQ(object.peak_force, 0.0) << "nothing presses on it";
}

TEST(ObjectFault, IsSeenAsAnObstacleAndNoBox) {
  SimulatedPlant plant(three_boxes(), "1", nominal("object@1,clear@2"));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
  perception::Observation seen = plant::observe(plant, {});
  ASSERT_EQ(seen.obstacles->size(), 1U);
  const Vector3 p_W = model::find_container(three_boxes(), "tote1")->X_WT * plant.objects()[0].X_TB.p;
  const geometry::Aabb bounds = perception::bounds_of(seen.obstacles->front().columns);
  EXPECT_NEAR(bounds.upper.z(), p_W.z() + 0.5 * kForeignSize.z(), 1e-6);
  const Vector3 middle = 0.5 * (bounds.lower + bounds.upper);
  EXPECT_LT((middle - p_W).head<2>().cwiseAbs().maxCoeff(), perception::kColumnSide);
  EXPECT_EQ(seen.seen.size(), 1U);
  ASSERT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed);
  EXPECT_TRUE(plant::observe(plant, {}).obstacles->empty()) << "taken out";
  EXPECT_FALSE(plant.objects()[0].is_in);
  ASSERT_EQ(fault_events(plant).size(), 2U);
  EXPECT_EQ(fault_events(plant)[1].text, "clear: foreign objects are taken out");
}

TEST(ObjectFault, ComesWithTheNextItemThatIsLetGoWhereItsOwnIsNot) {
  SimulatedPlant plant(three_boxes(), "1", nominal("object@1,noseal@1"));
  ASSERT_EQ(pack(plant, "BOX027").end.reason, EndReason::NoSeal);
  EXPECT_FALSE(plant.objects()[0].is_in);
  ASSERT_EQ(pack(plant, "BOX028").end.reason, EndReason::Completed);
  EXPECT_TRUE(plant.objects()[0].is_in);
  ASSERT_EQ(pack(plant, "BOX013").end.reason, EndReason::Completed);
  EXPECT_EQ(fault_events(plant).size(), 2U) << "not once more";
}

TEST(ObjectFault, ClearTakesOutNothingWhereNothingIs) {
  const auto plant = packed_with("clear@2");
  EXPECT_TRUE(plant->objects().empty());
  for (const std::string_view item : kItems) EXPECT_LT(off_by(*plant, item), kSamePlace) << item;
}

TEST(ObjectFault, IsNotPutWhereThereIsNoRoom) {
  model::Scenario small = three_boxes();
  for (model::Container& one : small.containers) one.inner_size = Vector3(0.08, 0.08, 0.25);
  const std::vector<Fault> faults{{FaultKind::Object, 1}};
  const cell::Simulation simulation(with_objects(small, faults), "1", {});
  cell::CellState state = simulation.make_state();
  const std::uint64_t before = simulation.hash(state);
  ForeignObjects objects(simulation, faults, 1);
  EXPECT_EQ(objects.put(state), nullptr) << "90 x 70 mm in 80 x 80 mm";
  EXPECT_EQ(simulation.hash(state), before);
}

/// A box is laid on it: its weight at least, and no more than when it were let fall from no height.
TEST(ObjectFault, FeelsTheWeightOfABoxThatIsLaidOnIt) {
  const std::vector<Fault> faults{{FaultKind::Object, 1}};
  const cell::Simulation simulation(with_objects(three_boxes(), faults), "1", {});
  cell::CellState state = simulation.make_state();
  cell::CellWorkspace work = simulation.make_workspace();
  ForeignObjects objects(simulation, faults, 3);
  ASSERT_NE(objects.put(state), nullptr);
  const Pose X_WE = simulation.scenario().controller.X_WE_start;
  const motion::PreparedProgram still =
      simulation.prepare({"still", {motion::make_waypoint(motion::MotionClass::Home, {}, X_WE)}});
  const auto run = [&](double seconds) {
    for (const double end = simulation.time(state) + seconds; simulation.time(state) < end;) {
      (void)simulation.advance(still, state, work);
      objects.watch(state, work);
    }
  };
  const physics::BodyId box = simulation.world().parcels[0];
  const Vector3 size = model::find_parcel(three_boxes(), "BOX027")->size;
  const auto lay_on = [&] {
    Pose X_WP = physics::pose_of(simulation.world().model, state.world, objects.objects()[0].body);
    X_WP.p.z() += 0.5 * (kForeignSize.z() + size.z());
    physics::set_present(state.world, box, true);
    physics::set_pose(simulation.world().model, state.world, box, X_WP);
    physics::set_twist(simulation.world().model, state.world, box, Twist{});
  };
  lay_on();
  run(0.2);
  EXPECT_EQ(objects.objects()[0].peak_force, 0.0) << "it counts from its rest on";
  objects.note_rest();
  lay_on();
  run(0.5);
  const double weight = 9.81 * model::find_parcel(three_boxes(), "BOX027")->inertia.mass;
  EXPECT_GE(objects.objects()[0].peak_force, 0.99 * weight);
  EXPECT_LE(objects.objects()[0].peak_force, 2.5 * weight) << "a spring that is loaded at once bears twice the weight";
}

TEST(ObjectFault, IsAtAnotherPlaceInAnotherPlantAndAtTheSameInTheSame) {
  const auto place = [](std::uint64_t seed) {
    SimulatedPlantOptions options = nominal("object@1");
    options.seed = seed;
    SimulatedPlant plant(three_boxes(), "1", options);
    EXPECT_EQ(pack(plant, "BOX027").end.reason, EndReason::Completed);
    return plant.objects()[0].X_TB.p;
  };
  EXPECT_EQ(place(1), place(1));
  EXPECT_NE(place(1), place(2));
}

TEST(FaultInjection, DisplaceAndPushOfOneItemBothHappen) {
  const auto plant = packed_with("displace@2,push@2");
  EXPECT_EQ(fault_events(*plant).size(), 2U);
}

TEST(ObjectFault, IsNotShotAwayByABoxThatAFaultMovesIntoIt) {
  SimulatedPlant plant(three_boxes(), "1", nominal("object@1,displace@2"));
  double fastest = 0.0;
  const auto look = [&](const cell::CellTick&) {
    const int body = plant.objects()[0].body.index;
    fastest = std::max(fastest, plant.state().world.bodies[static_cast<std::size_t>(body)].velocity.norm());
  };
  for (const char* item : {"BOX027", "BOX028"}) (void)pack(plant, item, look);
  EXPECT_LT((plant.objects()[0].X_TB.p - plant.objects()[0].X_TB_put.p).norm(), 0.005);
  EXPECT_LT(fastest, 0.5);
}

}  // namespace
}  // namespace snug::simulated_plant
