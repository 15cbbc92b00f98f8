// Rollouts and reach: parts come to the same bytes as the whole, and the arm may not touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cell/joint_pace.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/planning/reach.hpp"
#include "snug/planning/rollout.hpp"

namespace snug::planning {
namespace {

using model::test::shortened;

cell::SimulationOptions moved_by(const std::string& robot) {
  return {motion::LaggedTracking{}, cup::CupMode::Phases, robot};
}

packing::Placement placement_of(const model::Scenario& scenario, const Vector3& p_TP) {
  packing::Placement placement;
  placement.item = scenario.sequences.front().items.front().parcel;
  placement.X_TP.p = p_TP;
  return placement;
}

TEST(Reach, IsInTheContainerAndNotFarBehindIt) {
  const model::Scenario scenario = shortened(1);
  const skills::CellLayout layout = skills::make_layout(scenario, cell::find_pan_axis(scenario));
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
  EXPECT_FALSE(
      make_reach(scenario, skills::make_layout(scenario, cell::find_pan_axis(scenario)), scenario.sequences.front()));
  scenario.robot.reset();
  EXPECT_FALSE(
      make_reach(scenario, skills::make_layout(scenario, cell::find_pan_axis(scenario)), scenario.sequences.front()));
}

/// From the start to and fro over the container, and down to the bench.
motion::Program to_and_fro() {
  motion::Program program{"test", {}};
  const Pose X_WE = shortened(1).controller.X_WE_start;
  for (int i = 0; i < 6; ++i) {
    motion::Waypoint row = motion::make_waypoint(motion::MotionClass::Home, {}, X_WE);
    row.X_WE.p += Vector3(0.1 * (i % 3), 0.3 * (i % 2), 0.1 * (i % 2));
    program.waypoints.push_back(row);
  }
  return program;
}

TEST(Rollout, ComesToTheSameBytesPartByPartWithRestoresAsInOneRun) {
  const model::Scenario scenario = shortened(2);
  const motion::Program program = to_and_fro();
  Rollout whole(scenario, "1", moved_by("")), parts(scenario, "1", moved_by(""));
  EXPECT_TRUE(whole.run(program).is_complete());
  motion::Program begun{program.name, {}};
  for (std::size_t rows = 2; rows <= program.waypoints.size(); rows += 2) {
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

/// A soft post in the middle of the forearm at its start: it touches, but nothing stops the arm for protection.
model::Scenario with_post(model::Scenario scenario) {
  const cell::Simulation simulation(scenario, "1", {motion::LaggedTracking{}, cup::CupMode::Phases, "ur10"});
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

TEST(Rollout, FailsWhereALinkOfTheArmTouchesSomething) {
  const model::Scenario scenario = with_post(shortened(1));
  Rollout rollout(scenario, "1", moved_by("ur10"));
  motion::Waypoint row =
      motion::make_waypoint(motion::MotionClass::Home, {}, rollout.simulation().scenario().controller.X_WE_start);
  row.X_WE.p.x() += 0.05;
  const cell::CellState start = rollout.state();
  const Episode episode = rollout.run({"test", {row}});
  EXPECT_EQ(episode.end, RolloutEnd::ArmContact);
  EXPECT_NE(episode.text.find("touches post with"), std::string::npos) << episode.text;
  EXPECT_NE(episode.text.find("robot/forearm_link"), std::string::npos) << episode.text;
  rollout.restore(start);
  EXPECT_EQ(rollout.run({"test", {row}}, {.arm_may_touch = true}).arm_contact, episode.text);
}

TEST(Rollout, IsTakenUpWhereTheAnchorSaysAndNowhereElse) {
  const model::Scenario scenario = shortened(2);
  Rollout rollout(scenario, "1", moved_by(""));
  cell::CellAnchor anchor;
  anchor.X_WE = scenario.controller.X_WE_start;
  anchor.X_WE.p.z() += 0.1;
  const Pose on_floor = model::find_container(scenario, "tote1")->X_WT * Pose{Matrix3::Identity(), {0.0, 0.0, 0.0471}};
  anchor.boxes = {{1, on_floor}};
  rollout.take_up(anchor, 0.3);
  EXPECT_FALSE(rollout.pose_of(model::ItemIndex(0))) << "items that are not named are not there";
  ASSERT_TRUE(rollout.pose_of(model::ItemIndex(1)));
  EXPECT_LT((rollout.pose_of(model::ItemIndex(1))->p - on_floor.p).norm(), 1e-3);
  EXPECT_EQ(rollout.state().controller.command.X_WE, anchor.X_WE);
  EXPECT_EQ(rollout.state().controller.command.V_WE.linear.norm(), 0.0);
  EXPECT_FALSE(rollout.is_held(model::ItemIndex(1)));
  EXPECT_EQ(rollout.poses().size(), 2U);
  Rollout other(scenario, "1", moved_by(""));
  (void)other.run(to_and_fro());
  other.take_up(anchor, 0.3);
  EXPECT_EQ(other.simulation().hash(other.state()), rollout.simulation().hash(rollout.state()))
      << "what it did before is forgotten";
}

TEST(Rollout, PickedUpABoxIsHeldAndItsCupBearsItsWeight) {
  const model::Scenario scenario = shortened(1);
  motion::Program program = motion::load_program(SNUG_SOURCE_DIR "/src/snug/cell/test/demo_program.csv");
  program.waypoints.resize(3);  // to it, onto it, up
  Rollout rollout(scenario, "1", moved_by(""));
  const Episode episode = rollout.run(program);
  EXPECT_TRUE(episode.is_complete()) << episode.text;
  EXPECT_TRUE(rollout.is_held(model::ItemIndex(0)));
  const double weight = 9.81 * model::find_parcel(scenario, "BOX027")->inertia.mass;
  EXPECT_GE(episode.peak_force, weight);
  EXPECT_NEAR(rollout.state().gripper.F_S.force.norm(), weight, 0.25 * weight) << "it still swings";
  EXPECT_NEAR(episode.duration, rollout.time(), 1e-9);
  Rollout weak(scenario, "1", moved_by(""));
  const Episode broken_off = weak.run(program, {.force = 0.9 * weight});
  EXPECT_EQ(broken_off.end, RolloutEnd::TooMuchForce);
  EXPECT_GT(broken_off.peak_force, 0.9 * weight);
  EXPECT_LT(broken_off.duration, episode.duration);
  EXPECT_NE(broken_off.text.find("PostPick(BOX027)"), std::string::npos) << broken_off.text;
}

TEST(Episode, MergedKeepsTheLargerPeaksAllTheTimeAndTheFirstFailure) {
  Episode sum;
  merge(sum, {RolloutEnd::Completed, "", 10.0, 0.5, 2.0, ""});
  merge(sum, {RolloutEnd::TooMuchForce, "first", 30.0, 0.2, 1.0, "a touch"});
  merge(sum, {RolloutEnd::Failed, "second", 20.0, 0.9, 4.0, "another"});
  EXPECT_EQ(sum.end, RolloutEnd::TooMuchForce);
  EXPECT_EQ(sum.text, "first");
  EXPECT_EQ(sum.arm_contact, "a touch");
  EXPECT_EQ(sum.peak_force, 30.0);
  EXPECT_EQ(sum.peak_torque, 0.9);
  EXPECT_EQ(sum.duration, 7.0);
  EXPECT_FALSE(sum.is_complete());
}

TEST(Reach, OfAWayIsThatOfEveryPartOfIt) {
  const model::Scenario scenario = shortened(1);
  const ToolReach reaches = make_tool_reach(scenario);
  ASSERT_TRUE(reaches);
  const Pose start = scenario.controller.X_WE_start;
  Pose far = start, below = start;
  far.p.x() += 3.0;
  below.p += Vector3(0.1, 0.1, -0.1);
  EXPECT_TRUE(reaches({start, start}));
  EXPECT_TRUE(reaches({start, below}));
  EXPECT_TRUE(reaches({below, start}));
  EXPECT_FALSE(reaches({start, far})) << "its end";
  EXPECT_FALSE(reaches({far, start})) << "its begin";
}

}  // namespace
}  // namespace snug::planning
