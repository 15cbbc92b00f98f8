// Exports: what a real robot is given, read back by a few lines that know only the format.
#include "snug/control/program_export.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "exported.hpp"

namespace snug::control {
namespace {

using test::Exported;

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
  const Pose& goal = exported.plan.program.waypoints.back().X_WE;
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
