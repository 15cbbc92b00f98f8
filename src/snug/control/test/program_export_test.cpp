// Exports: what a real robot is given, read back by a few lines that know only the format.
#include "snug/control/program_export.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "demonstrator.hpp"
#include "snug/core/input_error.hpp"

namespace snug::control {
namespace {

motion::Program small_program() {
  motion::Program program{"test", {}};
  const auto row = [&](const Vector3& offset, const char* name, bool vacuum) {
    motion::Waypoint waypoint;
    waypoint.X_WE = test::demonstrator().controller.X_WE_start;
    waypoint.X_WE.p += offset;
    waypoint.name = name;
    waypoint.io.vacuum = vacuum;
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
};

TEST(UrScript, MovesTheToolInTheControllersBaseFrame) {
  const Exported exported;
  const std::string text =
      format_urscript(exported.plan, exported.controller.arm(), test::demonstrator().controller.X_WE_start, {3, 4});
  // W is the controller's base in this cell, so that the waypoint's own numbers appear.
  const Vector3 p = exported.plan.program.waypoints[1].X_WE.p;
  char expected[80];
  std::snprintf(expected, sizeof expected, "movel(p[%.6f, %.6f, %.6f,", p.x(), p.y(), p.z());
  EXPECT_NE(text.find(expected), std::string::npos) << text;
  EXPECT_NE(text.find("a=4.000, v=0.600"), std::string::npos);                         // Box
  EXPECT_NE(text.find("set_tcp(p[0.000000, 0.000000, 0.335000,"), std::string::npos);  // 35 mm sensor, 300 mm rod
  const std::size_t on = text.find("set_standard_digital_out(3, True)");
  ASSERT_NE(on, std::string::npos);
  EXPECT_LT(text.find("# 3 PostPick013"), on);  // acts before the motion to its row, then waits
  EXPECT_LT(on, text.find("sleep(0.500)"));
  EXPECT_LT(text.find("sleep(0.500)"), text.find("# 4 home"));
}

TEST(UrScript, NeedsTheFramesOfAUr) {
  const Exported exported;
  robot::ArmModel arm = exported.controller.arm();
  arm.links[static_cast<std::size_t>(robot::find_link(arm, "tool0"))].name = "other";
  EXPECT_THROW((void)format_urscript(exported.plan, arm, Pose{}, {}), InputError);
}

TEST(JointRun, EndsAtTheLastRow) {
  const Exported exported;
  ASSERT_TRUE(exported.run.is_complete);
  EXPECT_EQ(exported.run.samples.front().row, 0);
  EXPECT_EQ(exported.run.samples.back().row, 3);
  EXPECT_EQ(exported.run.samples.back().state, "Operation");
}

TEST(RosTrajectory, HasStrictlyGrowingTimesAndAllJoints) {
  const Exported exported;
  std::istringstream text(format_ros_trajectory(exported.run, exported.controller.arm(), 0.008, 0.04));
  double last = -1.0;
  int points = 0, names = 0;
  for (std::string line; std::getline(text, line);) {
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
