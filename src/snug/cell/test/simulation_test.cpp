// Simulation: programs that grow, snapshots, and states carried over to a slightly different cell.
#include "snug/cell/simulation.hpp"

#include <gtest/gtest.h>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"

namespace snug::cell {
namespace {

motion::Program demo_program(std::size_t rows = 16) {
  motion::Program first_rows = motion::load_program(kSource / "src/snug/cell/test/demo_program.csv");
  first_rows.waypoints.resize(rows);
  return first_rows;
}

/// Runs up to the tick that would end the program.
void run_to_end(const Simulation& simulation, const motion::PreparedProgram& plan, CellState& state,
                CellWorkspace& work) {
  while (!simulation.is_at_end(plan, state)) {
    ASSERT_FALSE(simulation.advance(plan, state, work).failure);
    ASSERT_LT(simulation.time(state), 200.0);
  }
}

std::uint64_t hash_at_end(const Simulation& simulation, const motion::Program& program) {
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  run_to_end(simulation, simulation.prepare(program), state, work);
  return simulation.hash(state);
}

TEST(Simulation, ExecutesRowsAppendedAtTheEndAsIfTheyHadBeenThere) {
  const Simulation simulation(demonstrator(), "1", {});
  const motion::Program whole = demo_program();
  motion::Program growing = whole;
  growing.waypoints.resize(8);
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  run_to_end(simulation, simulation.prepare(growing), state, work);
  growing = whole;
  run_to_end(simulation, simulation.prepare(growing), state, work);
  EXPECT_EQ(simulation.hash(state), hash_at_end(simulation, whole));
}

TEST(Simulation, GoesOnFromASnapshotWithTheSameBytes) {
  const Simulation simulation(demonstrator(), "1", {motion::LaggedTracking{}, cup::CupMode::Phases});
  const motion::PreparedProgram plan = simulation.prepare(demo_program());
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  for (int i = 0; i < 1000; ++i) (void)simulation.advance(plan, state, work);  // 8 s: a box hangs at the cup
  CellState snapshot = state;
  run_to_end(simulation, plan, state, work);
  CellWorkspace other = simulation.make_workspace();
  run_to_end(simulation, plan, snapshot, other);
  EXPECT_EQ(simulation.hash(state), simulation.hash(snapshot));
  EXPECT_EQ(state.event_log.events().size(), snapshot.event_log.events().size());
}

TEST(Simulation, GoesOnWithTheSameBytesWhenItsWorkspaceIsReplacedAgainAndAgain) {
  // Boxes that rest, sleep and are touched again: whatever a workspace remembers must not be seen in the state.
  const Simulation simulation(demonstrator(), "1", {motion::LaggedTracking{}, cup::CupMode::Phases});
  const motion::PreparedProgram plan = simulation.prepare(demo_program(64));
  CellState state = simulation.make_state();
  CellState restarted = state;
  CellWorkspace work = simulation.make_workspace();
  for (int part = 0; part < 40 && !simulation.is_at_end(plan, state); ++part) {
    CellWorkspace fresh = simulation.make_workspace();
    for (int i = 0; i < 333 && !simulation.is_at_end(plan, state); ++i) {
      (void)simulation.advance(plan, state, work);
      (void)simulation.advance(plan, restarted, fresh);
    }
    ASSERT_EQ(simulation.hash(state), simulation.hash(restarted)) << "at " << simulation.time(state) << " s";
  }
}

TEST(Simulation, IsTakenUpWhereItsBoxesAreBelievedToBeAndTheyStayThere) {
  const Simulation simulation(demonstrator(), "1", {});
  const motion::PreparedProgram plan = simulation.prepare(demo_program());
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  run_to_end(simulation, plan, state, work);
  CellAnchor anchor;
  anchor.X_WE = state.controller.command.X_WE;
  const auto& parcels = simulation.world().parcels;
  for (std::size_t i = 0; i < parcels.size(); ++i) {
    if (!state.world.bodies[static_cast<std::size_t>(parcels[i].index)].is_present) continue;
    anchor.boxes.push_back({static_cast<int>(i), physics::pose_of(simulation.world().model, state.world, parcels[i])});
  }
  ASSERT_FALSE(anchor.boxes.empty());
  CellState taken_up = simulation.take_up(anchor);
  EXPECT_EQ(simulation.time(taken_up), 0.0);
  const motion::PreparedProgram still =
      simulation.prepare({"still", {motion::make_waypoint(motion::MotionClass::Home, {}, anchor.X_WE)}});
  for (int i = 0; i < 50; ++i) ASSERT_FALSE(simulation.advance(still, taken_up, work).failure);
  for (const CellAnchor::Box& box : anchor.boxes) {
    const Pose X_WP =
        physics::pose_of(simulation.world().model, taken_up.world, parcels[static_cast<std::size_t>(box.item)]);
    EXPECT_LT((X_WP.p - box.X_WP.p).norm(), 5e-4) << "at rest before: contact forces are found anew in 0.4 s";
  }
}

TEST(Simulation, BringsABoxAndTakesAwayWhatStoodThere) {
  const Simulation simulation(demonstrator(), "1", {});
  CellState state = simulation.make_state();
  const auto is_there = [&](int item) {
    const int body = simulation.world().parcels[static_cast<std::size_t>(item)].index;
    return state.world.bodies[static_cast<std::size_t>(body)].is_present;
  };
  simulation.bring(0, state);
  EXPECT_TRUE(is_there(0));
  EXPECT_EQ(state.waiting_item, 0);
  simulation.bring(3, state);
  EXPECT_FALSE(is_there(0));
  EXPECT_TRUE(is_there(3));
}

TEST(Simulation, BeginsMotionsWhereTheToolIsAndStandsWhenToldTo) {
  const Simulation simulation(demonstrator(), "1", {});
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  Pose X_WE = state.controller.command.X_WE;
  X_WE.p.x() += 0.2;
  const motion::PreparedProgram away =
      simulation.prepare({"away", {motion::make_waypoint(motion::MotionClass::Home, {}, X_WE)}});
  for (int i = 0; i < 60; ++i) (void)simulation.advance(away, state, work);
  const motion::ToolState under_way = state.controller.command;
  ASSERT_GT(under_way.V_WE.linear.norm(), 0.01);
  simulation.begin_motion(state);
  EXPECT_EQ(state.controller.command, under_way);
  simulation.stand(state);
  EXPECT_EQ(state.controller.command.X_WE, under_way.X_WE);
  EXPECT_EQ(state.controller.command.V_WE.linear.norm(), 0.0);
}

TEST(Simulation, RefusesScenariosInWhichNoProgramCanRun) {
  model::Scenario without_tool = demonstrator();
  without_tool.tool.reset();
  EXPECT_THROW(Simulation(without_tool, "1", {}), InputError);
  EXPECT_THROW(Simulation(demonstrator(), "no such sequence", {}), InputError);
}

}  // namespace
}  // namespace snug::cell
