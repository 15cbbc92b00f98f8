// Packing with a robot: reach, programs that its wrist can do, and the same bytes item by item as in one run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cell/program_check.hpp"
#include "snug/cell/run.hpp"
#include "snug/task/reach.hpp"
#include "snug/task/session.hpp"

namespace snug::task {
namespace {

model::Scenario shortened(std::size_t count) {
  model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  scenario.sequences.front().items.resize(count);
  return scenario;
}

SessionOptions quick(const std::string& robot = {}) {
  SessionOptions options;
  options.packing.decision_time = 0.05;
  options.samples = 0;
  options.simulation.robot = robot;
  return options;
}

packing::Placement placement_of(const model::Scenario& scenario, const Vector3& p_TP) {
  packing::Placement placement;
  placement.item = scenario.sequences.front().items.front().parcel;
  placement.X_TP.p = p_TP;
  return placement;
}

TEST(Reach, IsInTheContainerAndNotFarBehindIt) {
  const model::Scenario scenario = shortened(1);
  const CellLayout layout = make_layout(scenario);
  const auto can = make_reach(scenario, layout, scenario.sequences.front());
  ASSERT_TRUE(can);
  for (const double x : {-0.12, 0.0, 0.12}) {
    for (const double y : {-0.22, 0.0, 0.22}) EXPECT_TRUE(can(placement_of(scenario, Vector3(x, y, 0.05))));
  }
  EXPECT_FALSE(can(placement_of(scenario, Vector3(1.0, 0.0, 0.05)))) << "1.5 m from the robot";
  EXPECT_FALSE(can(placement_of(scenario, Vector3(-0.505, 0.350, 0.3)))) << "in the robot's base";
}

TEST(Reach, IsNotAskedWithoutARobot) {
  model::Scenario scenario = shortened(1);
  scenario.robot->urdf = "nowhere.urdf";
  EXPECT_FALSE(make_reach(scenario, make_layout(scenario), scenario.sequences.front()));
  scenario.robot.reset();
  EXPECT_FALSE(make_reach(scenario, make_layout(scenario), scenario.sequences.front()));
}

/// Rows of `program` up to the next pick or place after `rows`.
std::size_t next_part(const motion::Program& program, std::size_t rows) {
  const auto begins = [&](std::size_t row) {
    const std::string& name = program.waypoints[row].name;
    return name.starts_with("PrePick") || name.starts_with("PrePlace");
  };
  for (++rows; rows < program.waypoints.size() && !begins(rows);) ++rows;
  return rows;
}

TEST(Lane, ComesToTheSameBytesPartByPartWithRestoresAsInOneRun) {
  const model::Scenario scenario = shortened(2);
  const SessionOptions options = quick();
  const motion::Program program = pack(scenario, "1", options).program;
  ASSERT_FALSE(program.waypoints.empty());
  Lane whole(scenario, "1", options.simulation), parts(scenario, "1", options.simulation);
  (void)whole.run(program);
  motion::Program begun{program.name, {}};
  for (std::size_t rows = 0; rows < program.waypoints.size();) {
    rows = next_part(program, rows);
    begun.waypoints.assign(program.waypoints.begin(), program.waypoints.begin() + static_cast<std::ptrdiff_t>(rows));
    const cell::CellState before = parts.state();
    (void)parts.run(begun);
    (void)parts.settle(begun, 0.2);  // an attempt that is not taken
    parts.restore(before);
    (void)parts.run(begun);
  }
  EXPECT_EQ(parts.simulation().hash(parts.state()), whole.simulation().hash(whole.state()));
  EXPECT_EQ(parts.state().controller, whole.state().controller);
}

TEST(Pack, WritesProgramsThatTheArmCanDo) {
  const model::Scenario scenario = shortened(3);
  const SessionResult packed = pack(scenario, "1", quick());
  EXPECT_EQ(packed.executed_boxes, 3) << packed.stopped;
  cell::CheckOptions check;
  check.sequence = "1";
  const cell::CheckResult result = cell::check_program(scenario, packed.program, check);
  EXPECT_TRUE(result.is_ok);
  for (const cell::CheckFinding& finding : result.findings) {  // being slower than planned is all it may be
    EXPECT_TRUE(finding.kind == cell::CheckKind::JointSpeed && !finding.is_error)
        << cell::name_of(finding.kind) << " " << finding.what << " toward " << finding.waypoint << ": "
        << finding.margin;
  }
  // It finds what cannot be done: the same program with its places 80 mm lower.
  motion::Program low = packed.program;
  for (motion::Waypoint& row : low.waypoints) {
    if (row.name.starts_with("Place")) row.X_WE.p.z() -= 0.08;
  }
  const cell::CheckResult refused = cell::check_program(scenario, low, check);
  EXPECT_FALSE(refused.is_ok);
  EXPECT_TRUE(std::ranges::any_of(refused.findings, [](const cell::CheckFinding& finding) {
    return finding.kind == cell::CheckKind::Collision && finding.waypoint.starts_with("Place");
  }));
}

/// A soft post in the middle of the forearm at its start: it touches, but nothing stops the arm for protection.
model::Scenario with_post(model::Scenario scenario) {
  const cell::Simulation simulation(scenario, "1", {motion::ControllerKind::Faithful, cup::CupMode::Phases, "ur10"});
  const robot::ArmModel& arm = simulation.arm()->model();
  const robot::ArmPose at = robot::forward(arm, simulation.arm()->start());
  const Vector3 elbow = at.X_WS[3].p, wrist = at.X_WS[4].p;
  model::Body post = scenario.bodies.front();
  post.name = "post";
  post.kind = model::BodyKind::Static;
  post.X_WB = Pose{Matrix3::Identity(), 0.5 * (elbow + wrist)};
  post.shapes = {{geometry::Box{Vector3::Constant(0.03)}, Pose{}}};
  scenario.bodies.push_back(post);
  scenario.robot->contact_stiffness = 500.0;
  scenario.robot->protective_stop.tracking_error = 10.0;
  return scenario;
}

TEST(Lane, FailsWhereALinkOfTheArmTouchesSomething) {
  const model::Scenario scenario = with_post(shortened(1));
  Lane lane(scenario, "1", quick("ur10").simulation);
  motion::Waypoint row;
  row.X_WE = lane.simulation().scenario().controller.X_WE_start;
  row.X_WE.p.x() += 0.05;
  row.name = "home";
  const cell::CellState start = lane.state();
  const Episode episode = lane.run({"test", {row}});
  EXPECT_NE(episode.failure.find("touches post with"), std::string::npos) << episode.failure;
  EXPECT_NE(episode.failure.find("robot/forearm_link"), std::string::npos) << episode.failure;
  EXPECT_FALSE(episode.was_stopped);
  lane.restore(start);
  EXPECT_EQ(lane.run({"test", {row}}, {.arm_may_touch = true}).arm_contact, episode.failure);
}

TEST(Pack, CountsAnAttemptInWhichTheArmTouchesSomethingAsFailed) {
  const model::Scenario scenario = shortened(1);
  packing::Placement upright = placement_of(scenario, Vector3(0.0, 0.0, 0.047));  // as it comes: picked from above
  upright.orientation = packing::nearest_orientation(Matrix3::Identity());
  const SessionResult packed = execute(with_post(scenario), "1", {upright}, quick("ur10"));
  EXPECT_EQ(packed.executed_boxes, 0);
  ASSERT_EQ(packed.items.size(), 1u);
  EXPECT_FALSE(packed.items[0].is_placed);
  EXPECT_NE(packed.items[0].reason.find("touches post"), std::string::npos) << packed.items[0].reason;
}

TEST(Pack, PacksWithTheArmAndLeavesAProgramThatRepeatsIt) {
  const model::Scenario scenario = shortened(1);
  const SessionOptions options = quick("ur10");
  const SessionResult packed = pack(scenario, "1", options);
  EXPECT_EQ(packed.executed_boxes, 1) << packed.stopped;
  cell::RunOptions again;
  again.program = motion::parse_program(motion::format_program(packed.program), "again");
  again.sequence = "1";
  again.simulation = options.simulation;
  const cell::RunResult repeated = cell::run(scenario, again);
  EXPECT_EQ(repeated.state_hash, packed.state_hash);
  EXPECT_EQ(repeated.duration, packed.duration);
}

}  // namespace
}  // namespace snug::task
