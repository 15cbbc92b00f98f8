// OutsideRun: a cell driven from outside is the cell that a program drives; what a controller must not do stops it.
#include "snug/runs/outside_run.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/writer.hpp"

namespace snug::runs {
namespace {

using cell::CellState;
using cell::CellWorkspace;
using cell::demonstrator;
using cell::OutsideCommand;
using cell::Simulation;

using control::DriveKind;
using robot::JointVector;

const Simulation& cell_with_robot() {
  static const Simulation kSimulation(demonstrator(), "1", {motion::LaggedTracking{}, cup::CupMode::Holding, "ur10"});
  return kSimulation;
}

OutsideCommand command_of(DriveKind kind, const JointVector& target) {
  return {{std::vector<DriveKind>(6, kind), target}, {}};
}

motion::Program to_the_side() {
  motion::Program program{"test", {}};
  for (const double y : {0.1, -0.1}) {
    motion::Waypoint row = motion::make_waypoint(motion::MotionClass::Home, {}, demonstrator().controller.X_WE_start);
    row.X_WE.p += Vector3(0.0, y, 0.05);
    program.waypoints.push_back(row);
  }
  return program;
}

TEST(OutsideRun, IsBitByBitTheRunOfAProgramWhoseSpeedsItIsGiven) {
  const Simulation& simulation = cell_with_robot();
  const motion::PreparedProgram plan = simulation.prepare(to_the_side());
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  OutsideRun run(simulation, {});
  ASSERT_TRUE(run.feed(0, 1));
  ASSERT_TRUE(simulation.feed(0, 1, state));
  for (int i = 0; i < 400; ++i) {
    (void)simulation.advance(plan, state, work);
    (void)run.advance(command_of(DriveKind::Speed, state.arm->machine.joints.qd));
    ASSERT_EQ(simulation.hash(run.state()), simulation.hash(state)) << i;
    ASSERT_EQ(run.reading().F_sensor, work.arm.F_sensor) << i;
  }
  EXPECT_FALSE(run.feed(0, 0)) << "the box is there";
  const RunResult result = run.finish("the test");
  EXPECT_EQ(result.state_hash, simulation.hash(state));
  EXPECT_EQ(result.ended_by, "the test");
  EXPECT_FALSE(result.failure) << result.failure.text;
}

TEST(OutsideRun, HoldsStillUnderTheTorqueOfItsWeight) {
  const Simulation& simulation = cell_with_robot();
  OutsideRun run(simulation, {});
  const JointVector start = simulation.arm()->start();
  const JointVector zero = JointVector::Zero(6);
  const JointVector torques =
      robot::inverse_dynamics(simulation.arm()->model(), {start, zero, zero}, Wrench{}, simulation.scenario().gravity);
  for (int i = 0; i < 125; ++i) (void)run.advance(command_of(DriveKind::Torque, torques));
  const control::JointMotion& joints = run.state().arm->machine.joints;
  // An equilibrium that nothing disturbs but rounding, 1e-13 Nm, that grows with the arm's fall: e^(3 t), 1 s.
  EXPECT_LT((joints.q - start).norm(), 1e-9);
  EXPECT_LT(joints.qd.norm(), 1e-9);
}

TEST(OutsideRun, FallsAsTheEquationsOfMotionSayWithoutTorque) {
  const Simulation& simulation = cell_with_robot();
  const robot::ArmModel& arm = simulation.arm()->model();
  OutsideRun run(simulation, {});
  const JointVector zero = JointVector::Zero(6);
  (void)run.advance(command_of(DriveKind::Torque, zero));
  // Reference: the same equations with a hundred times smaller steps over one tick.
  const double dt = 0.008 / 800;
  control::JointMotion fine{simulation.arm()->start(), zero, zero};
  const control::DriveCommand command = command_of(DriveKind::Torque, zero).joints;
  for (int i = 0; i < 800; ++i) {
    const JointVector qdd =
        control::compute_torque_accelerations(arm, command, fine, zero, simulation.scenario().gravity);
    fine.qd += dt * qdd;
    fine.q += dt * fine.qd;
  }
  const control::JointMotion& joints = run.state().arm->machine.joints;
  EXPECT_GT(fine.qd.norm(), 0.05);                                 // it falls
  EXPECT_LT((joints.qd - fine.qd).norm(), 0.05 * fine.qd.norm());  // first order in the physics step
  EXPECT_LT(std::abs(arm.joints[1].max_effort), 1e4);
}

TEST(OutsideRun, StopsForProtectionWithoutATorqueThatHolds) {
  const Simulation& simulation = cell_with_robot();
  OutsideRun run(simulation, {});
  JointVector torques = JointVector::Zero(6);
  torques[0] = 2.0 * simulation.arm()->model().joints[0].max_effort;
  (void)run.advance(command_of(DriveKind::Torque, torques));
  EXPECT_NE(run.failure().text.find("joint torque of shoulder_pan_joint"), std::string::npos) << run.failure().text;
  const RunResult result = run.finish("stop");
  ASSERT_TRUE(result.stop.has_value());
  EXPECT_EQ(result.stop->row, -1);
}

TEST(OutsideRun, StopsWhenAJointUnderTorqueIsTooFast) {
  const Simulation& simulation = cell_with_robot();
  OutsideRun run(simulation, {});
  for (int i = 0; i < 2000 && !run.failure(); ++i) {
    (void)run.advance(command_of(DriveKind::Torque, JointVector::Zero(6)));
  }
  EXPECT_NE(run.failure().text.find("protective stop"), std::string::npos) << "the arm falls until something stops it";
}

TEST(OutsideRun, LeavesARecordingLikeAnyOther) {
  const Simulation& simulation = cell_with_robot();
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "run.h5";
  OutputFile file = record::reserve_recording(path.string());
  OutsideRunOptions options;
  options.record_file = &file;
  options.describe = [](const RunResult& result) { return "{\"ended_by\": \"" + result.ended_by + "\"}"; };
  OutsideRun run(simulation, options);
  JointVector speeds = JointVector::Zero(6);
  speeds[5] = 0.2;
  for (int i = 0; i < 50; ++i) (void)run.advance(command_of(DriveKind::Speed, speeds));
  (void)run.finish("the controller left");
  const record::Recording recording = record::load_recording(path);
  EXPECT_EQ(recording.frames.size(), 50u);
  EXPECT_EQ(recording.header.joints.size(), 6u);
  EXPECT_EQ(recording.frames.back().joints[5].velocity, 0.2);
  EXPECT_EQ(recording.frames.back().program_row, -1);
}

}  // namespace
}  // namespace snug::runs
