// The robot in the cell: what stops it, where and why; what its sensor reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/record/reader.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/test/robot_rows.hpp"

namespace snug::runs {
namespace {

using cell::CellState;
using cell::CellWorkspace;
using cell::demonstrator;
using cell::describe;
using cell::FailureKind;
using cell::kSource;
using cell::Simulation;
using cell::StopCause;

using test::BallWrist;
using test::home;
using test::into_the_wall;
using test::row_at;
using test::simulate;
using test::turned_tool;
using test::wrist_into_the_wall;

TEST(Robot, ReadsTheWeightOfTheGripperWhenNothingIsHeld) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "run.h5";
  const RunResult result = simulate(demonstrator(), {row_at(home().p + Vector3(0.02, 0.0, 0.0))}, path);
  EXPECT_FALSE(result.stop) << result.failure.text;
  const record::Recording recording = record::load_recording(path);
  ASSERT_EQ(recording.header.joints.size(), 6u);
  const record::Frame& last = recording.frames.back();
  // 1 kg of gripper and cup; the tool moves by a few micrometres per second squared at most by then.
  EXPECT_NEAR(last.F_flange.force.norm(), 1.0 * 9.81, 1e-3);
  ASSERT_EQ(last.joints.size(), 6u);
  EXPECT_GT(std::abs(last.joints[1].torque), 20.0);  // the shoulder carries the arm
  EXPECT_LT(std::abs(last.joints[1].torque), 330.0);
  const int forearm = record::find_body(recording.header, "robot/forearm_link");
  ASSERT_GE(forearm, 0);
  EXPECT_NE(recording.frames.front().bodies[static_cast<std::size_t>(forearm)].X_WB,
            last.bodies[static_cast<std::size_t>(forearm)].X_WB);
}

TEST(Robot, AddsNoiseBiasAndDriftOfTheSensorFromTheSeed) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "run.h5";
  model::Scenario scenario = demonstrator();
  scenario.robot->sensor.force_noise = 0.5;
  scenario.robot->sensor.force_bias = Vector3(2.0, 0.0, 0.0);
  scenario.robot->sensor.torque_drift = Vector3(0.0, 0.1, 0.0);
  const auto record = [&] {
    (void)simulate(scenario, {row_at(home().p + Vector3(0.05, 0.0, 0.0))}, path);
    record::Recording recording = record::load_recording(path);
    return recording;
  };
  const record::Recording first = record(), second = record();
  ASSERT_EQ(first.frames.size(), second.frames.size());
  for (std::size_t i = 0; i < first.frames.size(); ++i) {
    ASSERT_EQ(first.frames[i].F_flange, second.frames[i].F_flange);
    ASSERT_EQ(first.frames[i].joints, second.frames[i].joints);
  }
  Vector3 mean = Vector3::Zero();
  double square = 0.0;
  for (const record::Frame& frame : first.frames)
    mean += frame.F_flange.force / static_cast<double>(first.frames.size());
  for (const record::Frame& frame : first.frames) {
    square += std::pow(frame.F_flange.force.y() - mean.y(), 2) / static_cast<double>(first.frames.size());
  }
  // Some hundred samples: the mean is known to 0.5 / sqrt(n) = 0.03, five of which are allowed; plus inertia forces.
  EXPECT_NEAR(mean.x(), 2.0, 0.25);
  EXPECT_NEAR(std::sqrt(square), 0.5, 0.15);
  EXPECT_NEAR(first.frames.back().F_flange.torque.y(), 0.1 * first.frames.back().time, 0.1);
}

TEST(Robot, StopsWhereItDrivesTheGripperIntoTheContainerWall) {
  const RunResult result = simulate(demonstrator(), into_the_wall());
  ASSERT_TRUE(result.stop) << result.failure.text;
  EXPECT_EQ(result.stop->row, 2);
  EXPECT_NE(result.stop->touching.find(demonstrator().target), std::string::npos) << describe(*result.stop);
  EXPECT_NE(result.stop->touching.find("tool"), std::string::npos) << describe(*result.stop);
  EXPECT_GT(result.stop->value, result.stop->limit);
  EXPECT_EQ(result.failure.text, describe(*result.stop));
  EXPECT_EQ(result.failure.kind, FailureKind::ProtectiveStop);
  EXPECT_EQ(result.events.back().kind, "protective_stop");
}

TEST(Robot, StopsWhereItDrivesAWristIntoTheWall) {
  const RunResult result = simulate(demonstrator(), wrist_into_the_wall());
  ASSERT_TRUE(result.stop) << result.failure.text;
  EXPECT_EQ(result.stop->row, 2);
  EXPECT_EQ(result.stop->cause, StopCause::JointTorque);  // behind the sensor nobody feels a wrist
  EXPECT_NE(result.stop->touching.find("robot/wrist_2_link"), std::string::npos) << describe(*result.stop);
}

const record::Event* find_event(const std::vector<record::Event>& events, const std::string& kind,
                                const std::string& body) {
  const auto found = std::find_if(events.begin(), events.end(),
                                  [&](const record::Event& event) { return event.kind == kind && event.body == body; });
  return found == events.end() ? nullptr : &*found;
}

TEST(Robot, RecordsWhatALinkTouchesWithTheForceOfTheRecordedContacts) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "run.h5";
  model::Scenario scenario = demonstrator();
  scenario.robot->protective_stop = {100.0, 1e6, 1e6, 100.0};  // nothing stops it
  std::vector<motion::Waypoint> rows = wrist_into_the_wall();
  rows.push_back(rows.front());
  const RunResult result = simulate(scenario, rows, path);
  EXPECT_FALSE(result.stop) << result.failure.text;
  const std::string& tote = demonstrator().target;
  const record::Event* begin = find_event(result.events, "arm_contact", tote);
  ASSERT_NE(begin, nullptr);
  EXPECT_NE(begin->text.find("robot/wrist_"), std::string::npos) << begin->text;
  double worst = 0.0;
  for (const record::Event& event : result.events) {
    if (event.kind != "arm_contact_end" || event.body != tote) continue;
    ASSERT_EQ(event.numbers.front().name, "force_N");
    worst = std::max(worst, event.numbers.front().value);
  }
  // The strongest contact of a link with the container in the recording: 32-bit numbers, one point a shape.
  const record::Recording recording = record::load_recording(path);
  double recorded = 0.0;
  for (const record::Frame& frame : recording.frames) {
    for (const record::ContactSample& contact : frame.contacts) {
      const std::string& a = recording.header.bodies[static_cast<std::size_t>(contact.body_a)].name;
      const std::string& b = recording.header.bodies[static_cast<std::size_t>(contact.body_b)].name;
      if (a == tote && b.starts_with("robot/")) recorded = std::max(recorded, contact.force_B_W.norm());
    }
  }
  EXPECT_GT(worst, 100.0);
  EXPECT_NEAR(worst, recorded, 1e-3 * worst);
}

TEST(Robot, SaysNothingOfTouchesWhereNoLinkTouches) {
  for (const record::Event& event : simulate(demonstrator(), {row_at(home().p + Vector3(0.1, 0.0, 0.0))}).events) {
    EXPECT_NE(event.kind, "arm_contact") << event.text;
  }
}

TEST(Robot, EndsTouchesWhereItStops) {
  const RunResult result = simulate(demonstrator(), wrist_into_the_wall());
  ASSERT_TRUE(result.stop);
  const record::Event* end = find_event(result.events, "arm_contact_end", demonstrator().target);
  ASSERT_NE(end, nullptr);
  EXPECT_GT(end->numbers.front().value, 10.0);
  EXPECT_EQ(result.events.back().kind, "protective_stop");
}

TEST(Robot, RunsAProgramInAScenarioWithoutLimits) {
  model::Scenario scenario = demonstrator();
  scenario.controller.limits.clear();
  const RunResult result = simulate(scenario, {row_at(home().p + Vector3(0.1, 0.0, 0.0), "any name")});
  EXPECT_FALSE(result.failure) << result.failure.text;
  // 0.1 m at 3 m/s^2 and 0.5 m/s takes 0.37 s, and the controller's lag some seconds.
  EXPECT_GT(result.duration, 0.37);
  EXPECT_LT(result.duration, 5.0);
}

TEST(Robot, WithoutAKnownEffortIsNotStoppedByATorque) {
  const BallWrist cell;  // effort 0 in its file
  const RunResult run = simulate(cell.scenario, {turned_tool(-0.3, 0.0), turned_tool(-0.4, 0.1)});
  EXPECT_FALSE(run.stop) << run.failure.text;
}

TEST(Robot, StopsWhenTheSensorIsOverloaded) {
  model::Scenario scenario = demonstrator();
  scenario.robot->protective_stop.sensor_force = 5.0;  // inertia alone is enough: 1 kg at 3 m/s^2 is near
  scenario.robot->protective_stop.torque_fraction = 10.0;
  const RunResult result = simulate(scenario, into_the_wall());
  ASSERT_TRUE(result.stop);
  EXPECT_EQ(result.stop->cause, StopCause::SensorForce);
  EXPECT_EQ(result.stop->where, scenario.robot->sensor_frame);
}

TEST(Robot, StandsAndSaysSoWhereARowIsOutOfReach) {
  const RunResult result = simulate(demonstrator(), {row_at(home().p), row_at(home().p + Vector3(0.0, -3.0, 0.0))});
  ASSERT_TRUE(result.stop);
  EXPECT_EQ(result.stop->cause, StopCause::Stuck);
  EXPECT_EQ(result.stop->row, 1);
  EXPECT_GT(result.stop->value, 1.0);
}

TEST(Robot, GoesOnFromASnapshotWithTheSameBytes) {
  model::Scenario scenario = demonstrator();
  scenario.robot->sensor.force_noise = 0.1;
  const Simulation simulation(scenario, "1", {motion::LaggedTracking{}, cup::CupMode::Holding, "ur10"});
  const motion::PreparedProgram plan =
      simulation.prepare({"test", {row_at(home().p + Vector3(0.1, 0.0, 0.0)), row_at(home().p)}});
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  for (int i = 0; i < 100; ++i) (void)simulation.advance(plan, state, work);
  CellState kept = state;
  for (int i = 0; i < 100; ++i) (void)simulation.advance(plan, state, work);
  CellWorkspace fresh = simulation.make_workspace();
  for (int i = 0; i < 100; ++i) (void)simulation.advance(plan, kept, fresh);
  EXPECT_EQ(simulation.hash(state), simulation.hash(kept));
  EXPECT_EQ(work.arm.F_sensor, fresh.arm.F_sensor);
}

TEST(Robot, IsRefusedUnderAnotherName) {
  RunOptions options;
  options.program = motion::Program{"test", {row_at(home().p)}};
  options.sequence = "1";
  options.simulation.robot = "ur5";
  EXPECT_THROW((void)run(demonstrator(), options), InputError);
  model::Scenario scenario = demonstrator();
  scenario.robot.reset();
  options.simulation.robot = "ur10";
  EXPECT_THROW((void)run(scenario, options), InputError);
}

TEST(Robot, PacksTheFirstBoxAsTheToolAloneDoes) {
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  RunOptions options;
  options.program = corrected(demonstrator(), motion::load_program(path), "seq1");
  options.program->waypoints.resize(8);
  options.sequence = "1";
  const RunResult alone = run(demonstrator(), options);
  options.simulation.robot = "ur10";
  const RunResult robot = run(demonstrator(), options);
  EXPECT_FALSE(robot.stop) << robot.failure.text;
  ASSERT_FALSE(alone.boxes.empty());
  ASSERT_EQ(robot.boxes.size(), alone.boxes.size());
  EXPECT_EQ(robot.boxes[0].state, alone.boxes[0].state);
  // The tool's ways differ by less than 0.1 mm where no limit is active; the shoulder's speed limit is, for some ticks.
  EXPECT_LT((robot.boxes[0].X_TP.p - alone.boxes[0].X_TP.p).norm(), 0.003);
}

}  // namespace
}  // namespace snug::runs
