// Simulation: programs that grow, snapshots, and states carried over to a slightly different cell.
#include "snug/cell/simulation.hpp"

#include <gtest/gtest.h>

#include "snug/cell/task.hpp"
#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"

namespace snug::cell {
namespace {

motion::Program demo_program(std::size_t rows = 16) {
  const auto file = kSource / "scenarios/demo-placements.yaml";
  const auto program = make_program(demonstrator(), "1", model::load_placements(file, demonstrator()), file.string());
  EXPECT_TRUE(program.has_value());
  motion::Program first_rows = *program;
  first_rows.waypoints.resize(rows);
  return first_rows;
}

/// Runs up to the tick that would end the program.
void run_to_end(const Simulation& simulation, const motion::PreparedProgram& plan, CellState& state,
                CellWorkspace& work) {
  while (!simulation.is_at_end(plan, state)) {
    ASSERT_EQ(simulation.advance(plan, state, work).failure, "");
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
  const Simulation simulation(demonstrator(), "1", {motion::ControllerKind::Faithful, cup::CupMode::Phases});
  const motion::PreparedProgram plan = simulation.prepare(demo_program());
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  for (int i = 0; i < 1000; ++i) (void)simulation.advance(plan, state, work);  // 8 s: a box hangs at the cup
  CellState snapshot = state;
  run_to_end(simulation, plan, state, work);
  CellWorkspace other = simulation.make_workspace();
  run_to_end(simulation, plan, snapshot, other);
  EXPECT_EQ(simulation.hash(state), simulation.hash(snapshot));
  EXPECT_EQ(state.journey.events().size(), snapshot.journey.events().size());
}

TEST(Simulation, GoesOnWithTheSameBytesWhenItsWorkspaceIsReplacedAgainAndAgain) {
  // Boxes that rest, sleep and are touched again: whatever a workspace remembers must not be seen in the state.
  const Simulation simulation(demonstrator(), "1", {motion::ControllerKind::Faithful, cup::CupMode::Phases});
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

TEST(Simulation, AdoptsAStateOfTheSameCellUnchangedAndKeepsPosesInAnotherOne) {
  const Simulation simulation(demonstrator(), "1", {});
  const motion::PreparedProgram plan = simulation.prepare(demo_program());
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  run_to_end(simulation, plan, state, work);
  EXPECT_EQ(simulation.hash(simulation.adopt(simulation, state)), simulation.hash(state));

  model::Scenario changed = demonstrator();
  for (model::Parcel& parcel : changed.parcels) {
    parcel.size *= 0.99;
    parcel.inertia.com.x() += 0.004;
  }
  const Simulation other(changed, "1", {});
  const CellState adopted = other.adopt(simulation, state);
  for (const physics::BodyId body : simulation.world().parcels) {
    const Pose before = physics::pose_of(simulation.world().model, state.world, body);
    const Pose after = physics::pose_of(other.world().model, adopted.world, body);
    EXPECT_LT((before.p - after.p).norm(), 1e-12);  // rounding of p_WBcm = X_WB p_BBcm and back
    EXPECT_LT(angle_between(before.R, after.R), 1e-7);
  }
}

TEST(Simulation, RefusesScenariosInWhichNoProgramCanRun) {
  model::Scenario without_tool = demonstrator();
  without_tool.tool.reset();
  EXPECT_THROW(Simulation(without_tool, "1", {}), InputError);
  EXPECT_THROW(Simulation(demonstrator(), "no such sequence", {}), InputError);
}

}  // namespace
}  // namespace snug::cell
