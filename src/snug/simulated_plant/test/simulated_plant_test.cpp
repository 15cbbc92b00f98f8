// SimulatedPlant: the contract of plants with and without the arm, faults, and the truth that is the seed's alone.
#include "snug/simulated_plant/simulated_plant.hpp"

#include <gtest/gtest.h>

#include <set>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/plant/test/suite/plant_contract.hpp"

namespace snug::simulated_plant {
namespace {

using plant::PlantContract;

const model::Scenario& scenario() {
  static const model::Scenario one = model::test::shortened(3);
  return one;
}

const plant::BoxAtAligner& box() {
  static const plant::BoxAtAligner one = [] {
    const model::Scenario fixed = cell::with_fixed_arrivals(scenario(), "1");
    return plant::BoxAtAligner{cell::arrival_pose(fixed, fixed.sequences.front().items.front()),
                               cup::pick_length(fixed.cup)};
  }();
  return one;
}

plant::PlantCase plant_case(const std::string& name, const std::string& robot) {
  return box().plant_case(name, [robot] {
    SimulatedPlantOptions options;
    options.seed = 7;
    options.simulation.robot = robot;
    return std::make_unique<SimulatedPlant>(scenario(), "1", options);
  });
}

INSTANTIATE_TEST_SUITE_P(Simulated, PlantContract,
                         testing::Values(plant_case("tool_alone", ""), plant_case("with_arm", "ur10")),
                         [](const auto& one) { return one.param.name; });

TEST(SimulatedPlant, IsTheScenarioItselfWithSeedZeroAndAnotherCellWithEachSeed) {
  EXPECT_EQ(draw_plant(scenario(), "1", 0), cell::with_fixed_arrivals(scenario(), "1"));
  EXPECT_EQ(draw_plant(scenario(), "1", 7), draw_plant(scenario(), "1", 7));
  EXPECT_NE(draw_plant(scenario(), "1", 7), draw_plant(scenario(), "1", 8));
}

TEST(SimulatedPlant, MayBeAnotherCellThanThePlannerBelieves) {
  SimulatedPlantOptions options;
  options.seed = 0;
  options.set = {{"parcel_clearance", "0.0005"}};
  const SimulatedPlant plant(scenario(), "1", options);
  EXPECT_EQ(plant.simulation().scenario().parcel_clearance, 0.0005);
  EXPECT_NE(scenario().parcel_clearance, 0.0005);
  options.set = {{"parcel_clearanc", "0.0005"}};
  EXPECT_THROW(SimulatedPlant(scenario(), "1", options), InputError);
}

SimulatedPlantOptions with_fault(FaultKind kind) {
  SimulatedPlantOptions options;
  options.seed = 7;
  options.faults = {{kind, 1}};
  return options;
}

/// From the pick over the bench, 0.5 m from the aligner.
plant::Motion carrying() {
  plant::Motion motion{model::ParcelId("BOX027"), box().pick(), {}};
  motion::Waypoint away = motion.waypoints.back();
  away.X_WE.p += Vector3(0.5, 0.0, 0.1);
  away.motion_class = motion::MotionClass::PrePlace;
  motion.waypoints.push_back(away);
  return motion;
}

TEST(SimulatedPlant, ABoxThatDoesNotSealIsFeltOnceAndPickedTheNextTime) {
  SimulatedPlant plant(scenario(), "1", with_fault(FaultKind::NoSeal));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  EXPECT_EQ(plant::run(plant, carrying()).end.reason, plant::EndReason::NoSeal);
  EXPECT_EQ(plant::run(plant, carrying()).end.reason, plant::EndReason::Completed);
}

TEST(SimulatedPlant, ABoxThatDropsIsFeltByItsVacuum) {
  SimulatedPlant plant(scenario(), "1", with_fault(FaultKind::Drop));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Feedback fed = plant::run(plant, carrying());
  EXPECT_EQ(fed.end.reason, plant::EndReason::VacuumLost);
  EXPECT_EQ(fed.end.waypoint, motion::WaypointIndex(3));
  EXPECT_LT(plant.motion_truth().hold_factor, 1e3) << "it hung from the cup before";
  const auto& events = plant.state().event_log.events();
  EXPECT_TRUE(std::ranges::any_of(events, [](const record::Event& event) { return event.kind == "fault"; }));
}

TEST(SimulatedPlant, AStopHoldsTheBoxAndAsksForAnAcknowledgement) {
  SimulatedPlant plant(scenario(), "1", with_fault(FaultKind::Stop));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const plant::Feedback stopped = plant::run(plant, carrying());
  EXPECT_EQ(stopped.end.reason, plant::EndReason::ProtectiveStop);
  EXPECT_LT(stopped.pressure_gauge, -1.0e4);
  const plant::Motion rest{model::ParcelId("BOX027"), {carrying().waypoints.back()}, {}};
  EXPECT_EQ(plant::run(plant, rest).end.reason, plant::EndReason::Refused);
  plant.acknowledge();
  EXPECT_EQ(plant::run(plant, rest).end.reason, plant::EndReason::Completed);
}

TEST(SimulatedPlant, AStopIsSaidBeforeItsMotionEndsAndNotAgain) {
  SimulatedPlant plant(scenario(), "1", with_fault(FaultKind::Stop));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  plant.start(carrying());
  std::string story;
  while (plant.is_moving()) {
    for (const plant::Event& event : plant.advance()) {
      const auto* fault = plant::get<plant::FaultRaised>(event);
      story += fault != nullptr ? "f" : plant::get<plant::MotionEnded>(event) != nullptr ? "e" : "";
      if (fault == nullptr) continue;
      EXPECT_EQ(fault->reason, plant::EndReason::ProtectiveStop);
      EXPECT_EQ(fault->where, "injected");
    }
  }
  EXPECT_EQ(story, "fe");
  EXPECT_EQ(plant::run(plant, carrying()).end.reason, plant::EndReason::Refused);
  plant.acknowledge();
  EXPECT_TRUE(plant.advance().empty());
  const plant::Motion rest{model::ParcelId("BOX027"), {carrying().waypoints.back()}};
  EXPECT_EQ(plant::run(plant, rest).end.reason, plant::EndReason::Completed);
}

/// Boxes that a fault moved come to rest tick by tick, and a motion can be cancelled meanwhile.
TEST(SimulatedPlant, WhatAFaultMovedRestsTickByTick) {
  SimulatedPlantOptions options;
  options.seed = 0;
  options.faults = {{FaultKind::Object, 1}};
  const motion::Program demo = motion::load_program(SNUG_SOURCE_DIR "/src/snug/cell/test/demo_program.csv");
  plant::Motion packing{model::ParcelId("BOX027"), {}};
  std::ranges::copy_if(demo.waypoints, std::back_inserter(packing.waypoints),
                       [](const motion::Waypoint& one) { return one.item == "BOX027"; });
  for (const bool is_cancelled : {false, true}) {
    SimulatedPlant plant(scenario(), "1", options);
    ASSERT_TRUE(plant::bring_and_wait(plant, packing.item));
    plant.start(packing);
    const double tick = scenario().controller.tick;
    int resting = 0;
    plant::EndReason reason = plant::EndReason::Completed;
    while (plant.is_moving()) {
      const double before = plant.read().time;
      for (const plant::Event& event : plant.advance()) {
        if (const auto* ended = plant::get<plant::MotionEnded>(event)) reason = ended->feedback.end.reason;
      }
      EXPECT_LE(plant.read().time - before, tick + 1e-9);
      resting += plant.objects()[0].is_in ? 1 : 0;
      if (is_cancelled && resting == 5) plant.cancel();
    }
    for (const plant::Event& event : plant.advance()) {
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) reason = ended->feedback.end.reason;
    }
    EXPECT_EQ(reason, is_cancelled ? plant::EndReason::Cancelled : plant::EndReason::Completed);
    EXPECT_TRUE(plant.objects()[0].has_rested);
    EXPECT_GE(resting, 5);
  }
}

/// What pressed on the arm when it was acknowledged presses on it still at the first tick of the way out.
TEST(SimulatedPlant, AStopByLoadIsLeftTheWayItCameButNotPressedOn) {
  SimulatedPlantOptions options;
  options.simulation.robot = "ur10";
  SimulatedPlant plant(scenario(), "1", options);
  const Pose above = plant.read().X_WE;
  Pose below = above;
  below.p.z() = -0.1;  // inside the workbench
  const auto to = [&](const Pose& X_WE) {
    return plant::run(
        plant, {model::ParcelId("BOX027"), {motion::make_waypoint(motion::MotionClass::Place, "BOX027", X_WE)}, {}});
  };
  for (int push = 0; push < 3; ++push) {
    const plant::Feedback stopped = to(below);
    ASSERT_EQ(stopped.end.reason, plant::EndReason::ProtectiveStop) << push;
    EXPECT_GT(stopped.X_WE.p.z(), -0.03) << "a tenth of a metre was asked for";
    plant.acknowledge();
  }
  EXPECT_EQ(to(above).end.reason, plant::EndReason::Completed);
  EXPECT_EQ(to(below).end.reason, plant::EndReason::ProtectiveStop) << "that limit is back";
}

/// Twenty seeds, one object after the other: inside the walls, apart from each other, and not the same place each time.
TEST(ForeignObjects, StandWhereThereIsRoomAtAPlaceDrawnByTheSeed) {
  const std::vector<Fault> faults{{FaultKind::Object, 1}, {FaultKind::Object, 2}};
  const cell::Simulation simulation(with_objects(scenario(), faults), "1", {});
  const model::Container& container = *model::find_container(scenario(), scenario().target);
  std::set<double> places;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    cell::CellState state = simulation.make_state();
    ForeignObjects objects(simulation, faults, seed);
    ASSERT_EQ(objects.objects().size(), 2U);
    for (int i = 0; i < 2; ++i) {
      const ForeignObject* one = objects.put(state);
      ASSERT_NE(one, nullptr);
      EXPECT_TRUE(cell::fit_in(container.inner_size, kForeignSize, one->X_TB).is_in);
    }
    EXPECT_EQ(objects.put(state), nullptr) << "there are two";
    const Vector3 apart = objects.objects()[0].X_TB.p - objects.objects()[1].X_TB.p;
    EXPECT_TRUE(apart.head<2>().cwiseAbs().maxCoeff() > kForeignSize.y() || apart.z() < -0.99 * kForeignSize.z());
    places.insert(objects.objects()[0].X_TB.p.x());
    objects.take_out(state);
    EXPECT_FALSE(objects.objects()[0].is_in);
    EXPECT_FALSE(state.world.bodies[static_cast<std::size_t>(objects.objects()[1].body.index)].is_present);
  }
  EXPECT_GT(places.size(), 8U);
}

TEST(ForeignObjects, AreNoPartOfACellWithoutSuchAFault) {
  EXPECT_EQ(with_objects(scenario(), {{FaultKind::Drop, 1}, {FaultKind::Clear, 2}}), scenario());
}

}  // namespace
}  // namespace snug::simulated_plant
