// The robot in the cell: what stops it, where and why; what its sensor reads; what a check says beforehand.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "snug/cell/corrected.hpp"
#include "snug/cell/program_check.hpp"
#include "snug/cell/run.hpp"
#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"

namespace snug::cell {
namespace {

const Pose& home() { return demonstrator().controller.X_WE_start; }

motion::Waypoint row_at(const Vector3& p_WE, const std::string& name = "home") {
  motion::Waypoint row;
  row.X_WE = {home().R, p_WE};
  row.name = name;
  return row;
}

RunResult simulate(const model::Scenario& scenario, std::vector<motion::Waypoint> rows,
                   const std::filesystem::path& record = {}) {
  RunOptions options;
  options.program = motion::Program{"test", std::move(rows)};
  options.sequence = "1";
  options.simulation.robot = "ur10";
  options.record_path = record;
  return run(scenario, options);
}

CheckResult check(std::vector<motion::Waypoint> rows, const std::string& sequence = "1") {
  CheckOptions options;
  options.sequence = sequence;
  return check_program(demonstrator(), motion::Program{"test", std::move(rows)}, options);
}

const CheckFinding* find(const std::vector<CheckFinding>& findings, CheckKind kind) {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](const CheckFinding& finding) { return finding.kind == kind; });
  return found == findings.end() ? nullptr : &*found;
}

/// Into the container and then sideways through its wall.
std::vector<motion::Waypoint> into_the_wall() {
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  const auto at = [&](double along, double height) {
    return tote.X_WT * Vector3(along, 0.0, tote.inner_size.z() + height);
  };
  return {row_at(at(0.0, 0.1)), row_at(at(0.0, -0.1)), row_at(at(0.5 * tote.inner_size.x() + 0.05, -0.1))};
}

/// Tool level, down into the container beside its wall, then the wrist against it.
std::vector<motion::Waypoint> wrist_into_the_wall() {
  std::vector<motion::Waypoint> rows;
  for (const Vector3& p : {Vector3(0.505, -0.45, 0.30), Vector3(0.505, -0.55, -0.05), Vector3(0.505, -0.50, -0.05)}) {
    rows.push_back(row_at(p));
    rows.back().X_WE.R = exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0));
  }
  return rows;
}

TEST(Robot, ReadsTheWeightOfTheGripperWhenNothingIsHeld) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "snug_robot_weight.h5";
  const RunResult result = simulate(demonstrator(), {row_at(home().p + Vector3(0.02, 0.0, 0.0))}, path);
  EXPECT_FALSE(result.stop) << result.failure;
  const record::Recording recording = record::load_recording(path);
  std::filesystem::remove(path);
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
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "snug_robot_noise.h5";
  model::Scenario scenario = demonstrator();
  scenario.robot->sensor.force_noise = 0.5;
  scenario.robot->sensor.force_bias = Vector3(2.0, 0.0, 0.0);
  scenario.robot->sensor.torque_drift = Vector3(0.0, 0.1, 0.0);
  const auto record = [&] {
    (void)simulate(scenario, {row_at(home().p + Vector3(0.05, 0.0, 0.0))}, path);
    record::Recording recording = record::load_recording(path);
    std::filesystem::remove(path);
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
  ASSERT_TRUE(result.stop) << result.failure;
  EXPECT_EQ(result.stop->row, 2);
  EXPECT_NE(result.stop->touching.find(demonstrator().target), std::string::npos) << describe(*result.stop);
  EXPECT_NE(result.stop->touching.find("tool"), std::string::npos) << describe(*result.stop);
  EXPECT_GT(result.stop->value, result.stop->limit);
  EXPECT_EQ(result.failure, describe(*result.stop));
  EXPECT_EQ(result.events.back().kind, "protective_stop");
}

TEST(Robot, StopsWhereItDrivesAWristIntoTheWall) {
  const RunResult result = simulate(demonstrator(), wrist_into_the_wall());
  ASSERT_TRUE(result.stop) << result.failure;
  EXPECT_EQ(result.stop->row, 2);
  EXPECT_EQ(result.stop->what, "joint torque");  // behind the sensor nobody feels a wrist
  EXPECT_NE(result.stop->touching.find("robot/wrist_2_link"), std::string::npos) << describe(*result.stop);
}

TEST(Robot, StopsWhenTheSensorIsOverloaded) {
  model::Scenario scenario = demonstrator();
  scenario.robot->protective_stop.sensor_force = 5.0;  // inertia alone is enough: 1 kg at 3 m/s^2 is near
  scenario.robot->protective_stop.torque_fraction = 10.0;
  const RunResult result = simulate(scenario, into_the_wall());
  ASSERT_TRUE(result.stop);
  EXPECT_EQ(result.stop->what, "sensor force");
  EXPECT_EQ(result.stop->where, scenario.robot->sensor_frame);
}

TEST(Robot, StandsAndSaysSoWhereARowIsOutOfReach) {
  const RunResult result = simulate(demonstrator(), {row_at(home().p), row_at(home().p + Vector3(0.0, -3.0, 0.0))});
  ASSERT_TRUE(result.stop);
  EXPECT_EQ(result.stop->what, "stuck");
  EXPECT_EQ(result.stop->row, 1);
  EXPECT_GT(result.stop->value, 1.0);
}

TEST(Robot, GoesOnFromASnapshotWithTheSameBytes) {
  model::Scenario scenario = demonstrator();
  scenario.robot->sensor.force_noise = 0.1;
  const Simulation simulation(scenario, "1", {motion::ControllerKind::Faithful, cup::CupMode::Holding, "ur10"});
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
  EXPECT_FALSE(robot.stop) << robot.failure;
  ASSERT_FALSE(alone.boxes.empty());
  ASSERT_EQ(robot.boxes.size(), alone.boxes.size());
  EXPECT_EQ(robot.boxes[0].state, alone.boxes[0].state);
  // The tool's ways differ by less than 0.1 mm where no limit is active; the shoulder's speed limit is, for some ticks.
  EXPECT_LT((robot.boxes[0].X_TP.p - alone.boxes[0].X_TP.p).norm(), 0.003);
}

TEST(Check, PassesTheDemonstratorsProgram) {
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  CheckOptions options;
  options.sequence = "1";
  const CheckResult result = check_program(demonstrator(), motion::load_program(path), options);
  std::string errors;
  for (const CheckFinding& finding : result.findings) {
    if (finding.is_error)
      errors += finding.waypoint + ": " + finding.what + " " + std::to_string(finding.margin) + "\n";
  }
  EXPECT_TRUE(result.is_ok) << errors;
  EXPECT_GT(result.looks, 1000);
  EXPECT_NE(find(result.margins, CheckKind::JointLimit), nullptr);
  EXPECT_NE(find(result.margins, CheckKind::Singularity), nullptr);
}

TEST(Check, FindsARowOutOfReach) {
  const CheckResult result = check({row_at(home().p), row_at(home().p + Vector3(0.0, -3.0, 0.0))});
  EXPECT_FALSE(result.is_ok);
  const CheckFinding* finding = find(result.findings, CheckKind::Reach);
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->row, 1);
  EXPECT_LT(finding->margin, -1.0);
}

TEST(Check, FindsTheWallThatTheGripperRunsInto) {
  const CheckResult result = check(into_the_wall());
  EXPECT_FALSE(result.is_ok);
  const auto finding = std::find_if(result.findings.begin(), result.findings.end(), [](const CheckFinding& found) {
    return found.kind == CheckKind::Collision && found.what == "gripper - " + demonstrator().target;
  });
  ASSERT_NE(finding, result.findings.end());
  EXPECT_EQ(finding->row, 2);
  EXPECT_TRUE(finding->is_error);
  // The rod's axis ends 50 mm beyond the inner face of a wall 10 mm thick; radius 20 mm: it is through.
  EXPECT_LT(finding->margin, -0.005);
}

TEST(Check, FindsTheWallThatAWristRunsInto) {
  const CheckResult result = check(wrist_into_the_wall());
  const auto finding = std::find_if(result.findings.begin(), result.findings.end(), [](const CheckFinding& found) {
    return found.kind == CheckKind::Collision && found.what == "wrist_2_link - " + demonstrator().target;
  });
  ASSERT_NE(finding, result.findings.end());
  EXPECT_EQ(finding->row, 2);
  EXPECT_LT(finding->margin, 0.0);
}

TEST(Check, FindsTheSingularityOnTheWay) {
  // Tool axis turned by a right angle about the wrist: the last axis comes parallel to the fourth.
  motion::Waypoint turned = row_at(home().p);
  turned.X_WE.R = exp_rotation(Vector3(0.0, 0.0, 0.0)) * turned.X_WE.R;
  const Simulation simulation(demonstrator(), "1", {motion::ControllerKind::Faithful, cup::CupMode::Holding, "ur10"});
  robot::JointVector q = simulation.arm()->start();
  q[4] -= 1.7;  // wrist 2 through zero
  turned.X_WE = robot::forward_tool(simulation.arm()->model(), q);
  const CheckResult result = check({row_at(home().p), turned});
  EXPECT_FALSE(result.is_ok);
  const CheckFinding* finding = find(result.findings, CheckKind::Singularity);
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->row, 1);
}

TEST(Check, LooksAtTheHeldBox) {
  // The box of the first pick, carried low over the rim: gripper and cup pass, the box does not.
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  motion::Program program = motion::load_program(path);
  std::vector<motion::Waypoint> rows(program.waypoints.begin(), program.waypoints.begin() + 3);
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  const Vector3 rim = tote.X_WT * Vector3(0.0, 0.0, tote.inner_size.z());
  motion::Waypoint high = row_at(rim + Vector3(0.0, 0.0, 0.3), "PrePlace");
  motion::Waypoint over =
      row_at(tote.X_WT * Vector3(0.5 * tote.inner_size.x(), 0.0, tote.inner_size.z() + 0.08), "PrePlace");
  high.io.vacuum = over.io.vacuum = true;
  rows.push_back(high);
  rows.push_back(over);
  const CheckResult with_box = check(rows), without = check(rows, "");
  const auto hits_tote = [](const CheckResult& result) {
    return std::any_of(result.findings.begin(), result.findings.end(), [](const CheckFinding& finding) {
      return finding.kind == CheckKind::Collision && finding.what.find("BOX") == 0;
    });
  };
  EXPECT_TRUE(hits_tote(with_box));
  EXPECT_FALSE(hits_tote(without));
}

}  // namespace
}  // namespace snug::cell
