// The robot in the cell: what stops it, where and why; what its sensor reads; what a check says beforehand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <utility>

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

const record::Event* find_event(const std::vector<record::Event>& events, const std::string& kind,
                                const std::string& body) {
  const auto found = std::find_if(events.begin(), events.end(),
                                  [&](const record::Event& event) { return event.kind == kind && event.body == body; });
  return found == events.end() ? nullptr : &*found;
}

TEST(Robot, RecordsWhatALinkTouchesWithTheForceOfTheRecordedContacts) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "snug_robot_touch.h5";
  model::Scenario scenario = demonstrator();
  scenario.robot->protective_stop = {100.0, 1e6, 1e6, 100.0};  // nothing stops it
  std::vector<motion::Waypoint> rows = wrist_into_the_wall();
  rows.push_back(rows.front());
  const RunResult result = simulate(scenario, rows, path);
  EXPECT_FALSE(result.stop) << result.failure;
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
  std::filesystem::remove(path);
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
  EXPECT_EQ(result.failure, "");
  // 0.1 m at 3 m/s^2 and 0.5 m/s takes 0.37 s, and the controller's lag some seconds.
  EXPECT_GT(result.duration, 0.37);
  EXPECT_LT(result.duration, 5.0);
}

/// An arm as most makers build it: three axes in the wrist that meet in a point, unlike a UR's. Efforts are not known.
std::string spherical_wrist() {
  struct Row {
    const char *origin, *axis;
    double limit, speed;
  };
  constexpr Row kRows[] = {{"0 0 0.4", "0 0 1", 2.9, 3.0}, {"0.2 0 0", "0 1 0", 2.0, 3.0},
                           {"0 0 0.6", "0 1 0", 2.0, 3.0}, {"0.3 0 0", "1 0 0", 6.1, 6.0},
                           {"0.3 0 0", "0 1 0", 2.2, 6.0}, {"0.1 0 0", "1 0 0", 6.1, 6.0}};
  std::string text = "<robot name=\"ball\"><link name=\"l0\"/>";
  int i = 0;
  for (const Row& row : kRows) {
    ++i;
    text += fmt::format(
        "<link name=\"l{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" "
        "izz=\"0.01\"/></inertial></link>\n<joint name=\"a{0}\" type=\"revolute\"><parent link=\"l{1}\"/>"
        "<child link=\"l{0}\"/><origin xyz=\"{2}\"/><axis xyz=\"{3}\"/>"
        "<limit lower=\"{4}\" upper=\"{5}\" effort=\"0\" velocity=\"{6}\"/></joint>\n",
        i, i - 1, row.origin, row.axis, -row.limit, row.limit, row.speed);
  }
  std::string parent = "l6";
  for (const char* name : {"flange", "ft_sensor", "E"}) {
    const bool is_tool = std::string(name) == "E";
    text += fmt::format(
        "<link name=\"{0}\"/><joint name=\"to_{0}\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}\"/>{2}"
        "</joint>\n",
        name, parent, is_tool ? "<origin xyz=\"0.3 0 0\" rpy=\"0 1.5707963267948966 0\"/>" : "");
    parent = name;
  }
  return text + "</robot>\n";
}

/// The demonstrator's cell with that arm, which points away from everything.
struct BallWrist {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "snug_ball_wrist.urdf";
  model::Scenario scenario = demonstrator();

  BallWrist() {
    std::ofstream(path) << spherical_wrist();
    model::RobotParams robot;
    robot.name = "ur10";
    robot.urdf = path.string();
    robot.X_WB.p = Vector3(0.0, 0.0, 0.3);
    robot.posture = robot.joints_start = {0.0, 0.0, 0.0, 0.0, -0.3, 0.0};
    robot.self_collision.clear();
    scenario.robot = robot;
  }
  ~BallWrist() { std::filesystem::remove(path); }
};

/// The tool turned about the middle of that wrist, which stays: pitch and yaw from where it points along the forearm.
motion::Waypoint turned_tool(double pitch, double yaw) {
  const Vector3 wrist(0.8, 0.0, 1.3);
  const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, yaw)) * exp_rotation(Vector3(0.0, pitch, 0.0));
  motion::Waypoint row;
  row.X_WE = {R * exp_rotation(Vector3(0.0, 0.5 * std::numbers::pi, 0.0)), wrist + R * Vector3(0.4, 0.0, 0.0)};
  row.name = "home";
  return row;
}

TEST(Check, DoesNotWindUpAWristThatTheControllerTakesThroughItsSingularity) {
  // Ten times around the direction in which two axes fall together: whoever follows the path exactly winds both up by
  // ten turns, 60 rad past limits of 6.1. The controller lets the tool give way by a degree.
  std::vector<motion::Waypoint> rows;
  for (int round = 0; round < 10; ++round) {
    for (const auto& [pitch, yaw] : {std::pair{-0.3, 0.01}, {0.3, 0.01}, {0.3, -0.01}, {-0.3, -0.01}}) {
      rows.push_back(turned_tool(pitch, yaw));
    }
  }
  const BallWrist cell;
  const RunResult run = simulate(cell.scenario, rows);
  EXPECT_FALSE(run.stop) << run.failure;
  CheckOptions options;
  const CheckResult result = check_program(cell.scenario, motion::Program{"test", rows}, options);
  EXPECT_EQ(find(result.findings, CheckKind::JointLimit), nullptr);
  EXPECT_EQ(find(result.findings, CheckKind::Reach), nullptr);
  EXPECT_NEAR(result.duration, run.duration, 0.02);
  EXPECT_NE(find(result.findings, CheckKind::Singularity), nullptr);
  // One line for all rows.
  const std::vector<CheckGroup> groups = group(result.findings);
  const auto singular = std::find_if(groups.begin(), groups.end(),
                                     [](const CheckGroup& one) { return one.worst.kind == CheckKind::Singularity; });
  ASSERT_NE(singular, groups.end());
  EXPECT_GE(singular->rows.size(), 15u);
  EXPECT_TRUE(std::is_sorted(singular->rows.begin(), singular->rows.end()));
}

TEST(Check, StopsAtALimitWhereTheRunDoes) {
  // The tool's own axis turned on and on: the last joint ends at its limit.
  std::vector<motion::Waypoint> rows;
  for (int i = 0; i <= 8; ++i) {
    rows.push_back(turned_tool(-0.3, 0.0));
    rows.back().X_WE.R = rows.back().X_WE.R * exp_rotation(Vector3(0.0, 0.0, 1.0 * i));
  }
  const BallWrist cell;
  const RunResult run = simulate(cell.scenario, rows);
  ASSERT_TRUE(run.stop);
  EXPECT_EQ(run.stop->what, "stuck");
  const CheckResult result = check_program(cell.scenario, motion::Program{"test", rows}, {});
  const CheckFinding* reach = find(result.findings, CheckKind::Reach);
  ASSERT_NE(reach, nullptr);
  EXPECT_EQ(reach->row, run.stop->row);
  EXPECT_NE(reach->what.find("a6 at its upper limit"), std::string::npos) << reach->what;
  EXPECT_EQ(find(result.findings, CheckKind::JointLimit), nullptr);
}

TEST(Robot, WithoutAKnownEffortIsNotStoppedByATorque) {
  const BallWrist cell;  // effort 0 in its file
  const RunResult run = simulate(cell.scenario, {turned_tool(-0.3, 0.0), turned_tool(-0.4, 0.1)});
  EXPECT_FALSE(run.stop) << run.failure;
}

TEST(Check, SaysHowFarTheCupIsInsideAndHowFarItMay) {
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  // The cup's ball of 30 mm lies 18 mm beyond E.
  const auto press = [&](double depth) {
    return check({row_at(tote.X_WT * Vector3(0.0, 0.0, 0.4)), row_at(tote.X_WT * Vector3(0.0, 0.0, 0.048 - depth))},
                 "");
  };
  const std::string what = "cup - " + demonstrator().target;
  const auto is_cup = [&](const CheckFinding& finding) { return finding.what == what; };
  const CheckResult allowed = press(0.02), beyond = press(0.04);
  EXPECT_TRUE(allowed.is_ok);
  const auto margin = std::find_if(allowed.margins.begin(), allowed.margins.end(), is_cup);
  ASSERT_NE(margin, allowed.margins.end());
  EXPECT_NEAR(margin->margin, -0.02, 0.006);  // the row is reached within 5 mm
  EXPECT_EQ(margin->allowance, 0.03);
  EXPECT_FALSE(beyond.is_ok);
  const auto finding = std::find_if(beyond.findings.begin(), beyond.findings.end(), is_cup);
  ASSERT_NE(finding, beyond.findings.end());
  EXPECT_NEAR(finding->margin, -0.04, 0.006);
  EXPECT_EQ(finding->allowance, 0.03);
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

TEST(Check, PassesTheDemonstratorsProgramAsItWasRunAndNotWithoutItsCorrections) {
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  CheckOptions options;
  options.sequence = "1";
  const motion::Program program = motion::load_program(path);
  const CheckResult result = check_program(demonstrator(), corrected(demonstrator(), program, "seq1"), options);
  std::string errors;
  for (const CheckFinding& finding : result.findings) {
    if (finding.is_error)
      errors += finding.waypoint + ": " + finding.what + " " + std::to_string(finding.margin) + "\n";
  }
  EXPECT_TRUE(result.is_ok) << errors;
  EXPECT_GT(result.looks, 1000);
  EXPECT_NE(find(result.margins, CheckKind::JointLimit), nullptr);
  EXPECT_NE(find(result.margins, CheckKind::Singularity), nullptr);
  // Without them the turned box 016 is picked up 38 mm off (simulated, too: the cup misses it).
  const CheckResult off = check_program(demonstrator(), program, options);
  EXPECT_FALSE(off.is_ok);
  for (const CheckFinding& finding : off.findings) {
    if (!finding.is_error) continue;
    EXPECT_EQ(finding.what, "BOX016 - " + demonstrator().target) << finding.waypoint;
    EXPECT_NEAR(finding.margin, -0.0375, 0.004);
  }
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
  // Wrist 2 is at a right angle at home; where it comes to zero the last axis is parallel to the fourth.
  const Simulation simulation(demonstrator(), "1", {motion::ControllerKind::Faithful, cup::CupMode::Holding, "ur10"});
  const auto turned_by = [&](double angle) {
    robot::JointVector q = simulation.arm()->start();
    q[4] -= angle;
    motion::Waypoint turned = row_at(home().p);
    turned.X_WE = robot::forward_tool(simulation.arm()->model(), q);
    return check({row_at(home().p), turned}, "");
  };
  const CheckResult before = turned_by(1.3);
  EXPECT_EQ(find(before.findings, CheckKind::Singularity), nullptr) << "0.27 rad before it";
  EXPECT_GT(find(before.margins, CheckKind::Singularity)->margin, 0.0);
  const CheckResult result = turned_by(1.7);
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
