// Exports: what a real robot is given, read back by a few lines that know only the format.
#include "snug/control/program_export.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::control {
namespace {

motion::Program small_program() {
  motion::Program program{"test", {}};
  const auto row = [&](const Vector3& offset, const char* name, bool vacuum) {
    motion::Waypoint waypoint =
        motion::named_waypoint(name, test::demonstrator().controller.X_WE_start, {.vacuum = vacuum});
    waypoint.p_WE += offset;
    program.waypoints.push_back(waypoint);
  };
  row({0.1, 0.0, 0.0}, "PrePick013", false);
  row({0.1, 0.0, -0.05}, "Box013", false);
  row({0.1, 0.0, 0.0}, "PostPick013", true);
  row({0.0, 0.05, 0.0}, "home", true);
  return program;
}

struct Exported {
  JointController controller = test::make_controller();
  motion::PreparedProgram plan =
      motion::prepare(small_program(), test::program_settings(motion::ControllerKind::Faithful));
  JointRun run = run_joints(plan, controller, make_demonstrator_machine(), test::start_joints(controller));

  [[nodiscard]] RobotProgram for_robot() const {
    return {plan, controller.arm(), test::start_joints(controller), std::vector<std::optional<CarriedLoad>>(4)};
  }
};

// What a script does when it runs: tests/urscript_test.py.
TEST(UrScript, MovesTheToolInTheControllersBaseFrame) {
  const Exported exported;
  const UrScript script = format_urscript(exported.for_robot(), {3, 4, 5, 2.0});
  const std::string& text = script.text;
  // W is the controller's base in this cell, so that the waypoint's own numbers appear.
  const Vector3 p = exported.plan.program.waypoints[1].X_WE().p;
  char expected[80];
  std::snprintf(expected, sizeof expected, "movel(p[%.6f, %.6f, %.6f,", p.x(), p.y(), p.z());
  EXPECT_NE(text.find(expected), std::string::npos) << text;
  EXPECT_NE(text.find("a=4.00000, v=0.60000"), std::string::npos);                     // Box
  EXPECT_NE(text.find("set_tcp(p[0.000000, 0.000000, 0.335000,"), std::string::npos);  // 35 mm sensor, 300 mm rod
  const std::size_t on = text.find("set_standard_digital_out(3, True)");
  ASSERT_NE(on, std::string::npos);
  EXPECT_LT(text.find("# 3 PostPick013"), on);  // acts before the motion to its row, then waits
  const std::size_t wait = text.find("snug_wait_for_vacuum(True");
  EXPECT_LT(on, wait);
  EXPECT_LT(wait, text.find("movel(", on));
  EXPECT_EQ(script.moves, 4);
}

TEST(UrScript, CapsBlendsByTheMovesOnBothSides) {
  // Rows that may be passed at 0.05 m, 0.2 to 120 mm apart, in random directions.
  Rng rng = Rng(5).split("blends");
  motion::Program program{"test", {}};
  Pose X_WE = test::demonstrator().controller.X_WE_start;
  for (int i = 0; i < 300; ++i) {
    const Vector3 way(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (i % 7 != 3) X_WE.p += way.normalized() * std::pow(10.0, rng.uniform(-3.7, -0.92));  // else no way at all
    program.waypoints.push_back(motion::named_waypoint("PostPick013", X_WE));
  }
  const JointController controller = test::make_controller();
  const motion::PreparedProgram plan =
      motion::prepare(program, test::program_settings(motion::ControllerKind::Faithful));
  const UrScript script = format_urscript({plan, controller.arm(), test::start_joints(controller),
                                           std::vector<std::optional<CarriedLoad>>(program.waypoints.size())},
                                          {});
  std::istringstream lines(script.text);
  Vector3 before = test::demonstrator().controller.X_WE_start.p;
  double blend_before = 0.0;
  int moves = 0, blends = 0;
  for (std::string line; std::getline(lines, line);) {
    Vector3 p;
    if (std::sscanf(line.c_str(), "  movel(p[%lf, %lf, %lf,", &p.x(), &p.y(), &p.z()) != 3) continue;
    const std::size_t at = line.find(", r=");
    const double blend = at == std::string::npos ? 0.0 : std::stod(line.substr(at + 4));
    const double length = (p - before).norm();
    EXPECT_GT(length, 1e-4) << line;
    EXPECT_LT(blend + blend_before, length) << line;
    EXPECT_LE(blend, 0.05);
    before = p;
    blend_before = blend;
    ++moves;
    blends += blend > 0.0 ? 1 : 0;
  }
  EXPECT_EQ(blend_before, 0.0) << "the last move ends in a stop";
  EXPECT_EQ(moves, script.moves);
  EXPECT_EQ(moves, 300 - 43);
  EXPECT_GT(blends, 60);  // of 257 moves, 0.2 to 120 mm: two of five have both neighbours long enough
}

TEST(UrScript, TellsTheControllerWhatTheGripperCarries) {
  Exported exported;
  RobotProgram program = exported.for_robot();
  program.loads[2] = program.loads[3] = CarriedLoad{2.0, Vector3(0.01, 0.0, 0.1)};
  const std::string text = format_urscript(program, {}).text;
  const SpatialInertia gripper = robot::distal_inertia(program.arm, robot::find_link(program.arm, "tool0"));
  char expected[80];
  std::snprintf(expected, sizeof expected, "set_payload(%.4f, [", gripper.mass);
  EXPECT_LT(text.find(expected), text.find("movel("));
  std::snprintf(expected, sizeof expected, "set_payload(%.4f, [", gripper.mass + 2.0);
  const std::size_t at = text.find(expected);
  ASSERT_NE(at, std::string::npos) << text;
  Vector3 com;
  ASSERT_EQ(std::sscanf(text.c_str() + at + std::strlen(expected), "%lf, %lf, %lf", &com.x(), &com.y(), &com.z()), 3);
  // E is turned by half a turn about z against tool0, 335 mm before it.
  const Vector3 moment = gripper.mass * gripper.com + 2.0 * Vector3(-0.01, 0.0, 0.335 + 0.1);
  EXPECT_LT((com - moment / (gripper.mass + 2.0)).norm(), 2e-5);
}

TEST(UrScript, IsRefusedForAnArmThatIsNoUr) {
  const Exported exported;
  const auto expect_refused = [&](const robot::ArmModel& arm, const std::string& part) {
    RobotProgram program{exported.plan, arm, test::start_joints(exported.controller), exported.for_robot().loads};
    try {
      (void)format_urscript(program, {});
      ADD_FAILURE() << "accepted; expected a complaint with '" << part << "'";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("ros-trajectory"), std::string::npos) << error.what();
    }
  };
  robot::ArmModel arm = exported.controller.arm();
  arm.links[static_cast<std::size_t>(robot::find_link(arm, "tool0"))].name = "other";
  expect_refused(arm, "tool0");
  arm = exported.controller.arm();
  arm.joints[3].name = "joint_a4";
  expect_refused(arm, "wrist_1_joint");
  arm = exported.controller.arm();
  arm.joints[4].X_SJ.R = exp_rotation(Vector3(0.3, 0.0, 0.0)) * arm.joints[4].X_SJ.R;
  expect_refused(arm, "axes");
  arm = exported.controller.arm();
  arm.joints.pop_back();
  expect_refused(arm, "5 joints");
}

TEST(JointRun, EndsAtTheLastRow) {
  const Exported exported;
  ASSERT_TRUE(exported.run.is_complete);
  EXPECT_EQ(exported.run.samples.front().row, 0);
  EXPECT_EQ(exported.run.samples.back().row, 3);
  EXPECT_EQ(exported.run.samples.back().state, "Operation");
}

TEST(JointRun, ComesToRestWithoutAJump) {
  const Exported exported;
  const JointState& end = exported.run.samples.back().after;
  EXPECT_EQ(end.qd.norm(), 0.0);
  const Pose& goal = exported.plan.program.waypoints.back().X_WE();
  EXPECT_LT((robot::forward_tool(exported.controller.arm(), end.q).p - goal.p).norm(), 1e-3);
  for (std::size_t i = 1; i < exported.run.samples.size(); ++i) {
    const JointSample& sample = exported.run.samples[i];
    EXPECT_EQ(sample.before.q, exported.run.samples[i - 1].after.q);
    EXPECT_NEAR(sample.time, 0.008 * static_cast<double>(i), 1e-9);
    EXPECT_LE((sample.after.qd - sample.before.qd).cwiseAbs().maxCoeff() / 0.008, 15.0 + 1e-9);
  }
}

TEST(RosTrajectory, HasStrictlyGrowingTimesAndAllJoints) {
  const Exported exported;
  std::istringstream text(format_ros_trajectory(exported.run, exported.for_robot(), 0.04));
  double last = -1.0;
  int points = 0, names = 0, tools = 0;
  for (std::string line; std::getline(text, line);) {
    if (line.find("# tool: p[0.000000, 0.000000, 0.335000,") == 0) ++tools;  // 35 mm sensor, 300 mm rod
    long long seconds = 0, nanoseconds = 0;
    if (line.find("_joint") != std::string::npos) ++names;
    if (std::sscanf(line.c_str(), "    time_from_start: {sec: %lld, nanosec: %lld}", &seconds, &nanoseconds) != 2)
      continue;
    ++points;
    const double time = static_cast<double>(seconds) + 1e-9 * static_cast<double>(nanoseconds);
    EXPECT_LT(nanoseconds, 1'000'000'000);
    EXPECT_GT(time, last);
    last = time;
  }
  EXPECT_EQ(tools, 1);
  EXPECT_EQ(names, 6);
  EXPECT_EQ(points, static_cast<int>((exported.run.samples.size() + 4) / 5) + 1);
  EXPECT_NEAR(last, exported.run.samples.back().time + 0.008, 1e-8);
}

TEST(Log, IsTheSameInBothForms) {
  const Exported exported;
  const std::vector<LogColumn> log = make_log(exported.run, exported.controller.arm(), test::demonstrator().gravity);
  const std::string csv = format_log_csv(log), flat = format_log_flat(log);
  std::istringstream lines(csv);
  std::string header, line;
  std::getline(lines, header);
  EXPECT_EQ(header.substr(0, 9), "t;qIn_0;q");
  EXPECT_NE(header.find("ur10_FloatingBase_orientation_w"), std::string::npos);
  std::size_t rows = 0;
  while (std::getline(lines, line)) ++rows;
  EXPECT_EQ(rows, exported.run.samples.size());

  std::size_t at = 0;
  const auto count = [&] {
    std::uint64_t value = 0;
    std::memcpy(&value, flat.data() + at, sizeof value);
    at += sizeof value;
    return static_cast<std::size_t>(value);
  };
  const std::size_t entries = count();
  ASSERT_EQ(entries, log.size());
  for (const LogColumn& column : log) {
    const bool is_numeric = flat[at++] == 1;
    const std::size_t name = count();
    EXPECT_EQ(flat.substr(at, name), column.name);
    at += name;
    const std::size_t samples = count();
    ASSERT_EQ(samples, exported.run.samples.size());
    for (std::size_t i = 0; i < samples; ++i) {
      if (is_numeric) {
        double value = 0.0;
        std::memcpy(&value, flat.data() + at, sizeof value);
        at += sizeof value;
        EXPECT_EQ(value, column.numbers[i]);
      } else {
        const std::size_t size = count();
        EXPECT_EQ(flat.substr(at, size), "Operation");
        at += size;
      }
    }
  }
  EXPECT_EQ(at, flat.size());
}

}  // namespace
}  // namespace snug::control
