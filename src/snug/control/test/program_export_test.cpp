// Exports: what a real robot is given, read back by a few lines that know only the format.
#include "snug/control/program_export.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "exported.hpp"
#include "snug/core/input_error.hpp"

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
  EXPECT_GE(points, static_cast<int>((exported.run.samples.size() + 4) / 5) + 1);
  EXPECT_LE(points, static_cast<int>(exported.run.samples.size()) + 2);
  EXPECT_NEAR(last, exported.run.samples.back().time + 0.016, 1e-8);
}

/// Points of a trajectory, read back.
struct ReadPoint {
  double time = 0.0;
  std::vector<double> q, qd, qdd;
};

std::vector<ReadPoint> points_of(const std::string& text) {
  std::vector<ReadPoint> points;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto list = [&] {
      std::vector<double> values;
      std::istringstream words(line.substr(line.find('[') + 1));
      for (double value; words >> value; words.ignore(1)) values.push_back(value);
      return values;
    };
    long long seconds = 0, nanoseconds = 0;
    if (line.find("- positions:") != std::string::npos) points.push_back({0.0, list(), {}, {}});
    if (line.find("    velocities:") == 0) points.back().qd = list();
    if (line.find("    accelerations:") == 0) points.back().qdd = list();
    if (std::sscanf(line.c_str(), "    time_from_start: {sec: %lld, nanosec: %lld}", &seconds, &nanoseconds) == 2)
      points.back().time = static_cast<double>(seconds) + 1e-9 * static_cast<double>(nanoseconds);
  }
  return points;
}

/// Of the quintic polynomial with position, speed and acceleration at 0 and T, by the textbook's six conditions.
std::array<double, 3> quintic(const ReadPoint& a, const ReadPoint& b, std::size_t j, double t) {
  const double T = b.time - a.time;
  Eigen::Matrix<double, 6, 6> A;
  Eigen::Matrix<double, 6, 1> y;
  const auto rows = [](double x) {
    Eigen::Matrix<double, 3, 6> m;
    m << 1, x, x * x, x * x * x, std::pow(x, 4), std::pow(x, 5),    //
        0, 1, 2 * x, 3 * x * x, 4 * x * x * x, 5 * std::pow(x, 4),  //
        0, 0, 2, 6 * x, 12 * x * x, 20 * x * x * x;
    return m;
  };
  A << rows(0.0), rows(T);
  y << a.q[j], a.qd[j], a.qdd[j], b.q[j], b.qd[j], b.qdd[j];
  const Eigen::Matrix<double, 6, 1> c = A.fullPivLu().solve(y);
  const Eigen::Vector3d found = rows(t) * c;
  return {found[0], found[1], found[2]};
}

TEST(RosTrajectory, StaysWithinTheLimitsOfTheRunByQuinticInterpolation) {
  for (const motion::Tracking& tracking :
       {motion::Tracking(motion::LaggedTracking{}), motion::Tracking(motion::FastTracking{})}) {
    const Exported exported{tracking};
    const std::vector<JointSample>& samples = exported.run.samples;
    double most = 0.0;
    for (const JointSample& one : samples)
      most = std::max(most, (one.after.qd - one.before.qd).cwiseAbs().maxCoeff() / 0.008);
    const std::vector<ReadPoint> points = points_of(format_ros_trajectory(exported.run, exported.for_robot(), 0.08));
    ASSERT_GT(points.size(), samples.size() / 10);
    std::size_t sample = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      EXPECT_LE(points[i + 1].time - points[i].time, 0.08 + 1e-9);
      for (int look = 0; look < 10; ++look) {
        for (std::size_t j = 0; j < 6; ++j) {
          const auto [q, qd, qdd] =
              quintic(points[i], points[i + 1], j, 0.1 * look * (points[i + 1].time - points[i].time));
          EXPECT_LT(std::abs(qdd), most + 1e-4) << points[i].time << " joint " << j;
          EXPECT_LT(std::abs(qd), exported.controller.arm().joints[j].max_speed);
          (void)q;
        }
      }
      for (; sample < samples.size() && samples[sample].time + 0.004 < points[i + 1].time - 1e-9; ++sample) {
        for (std::size_t j = 0; j < 6; ++j) {
          const auto [q, qd, qdd] = quintic(points[i], points[i + 1], j, samples[sample].time + 0.004 - points[i].time);
          EXPECT_NEAR(q, samples[sample].before.q[static_cast<Eigen::Index>(j)], 2e-4);
        }
      }
    }
    EXPECT_EQ(sample, samples.size());
  }
}

/// Accelerations that jump by all that a joint has, each tick: a polynomial through them as they are would swing
/// to 1.25 times the largest and more.
TEST(RosTrajectory, StaysWithinTheAccelerationOfARunThatJerks) {
  Exported exported;
  JointRun run;
  JointState state{exported.run.samples.front().before};
  state.qd.setZero();
  const double most = 15.0, tick = 0.008;
  for (const double share : {1.0, -1.0, 0.0, 1.0, 1.0, -1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 0.3, -0.3}) {
    JointSample sample = exported.run.samples.front();
    sample.time = tick * static_cast<double>(run.samples.size());
    sample.before = state;
    state.qdd.setConstant(6, share * most);
    state.q += tick * (state.qd + 0.5 * tick * state.qdd);
    state.qd += tick * state.qdd;
    sample.after = state;
    run.samples.push_back(sample);
  }
  for (const double period : {0.008, 0.08}) {
    const std::vector<ReadPoint> points = points_of(format_ros_trajectory(run, exported.for_robot(), period));
    ASSERT_GE(points.size(), 5U);
    EXPECT_NEAR(points.front().q[0], run.samples.front().before.q[0], 1e-8);
    EXPECT_NEAR(points.back().q[0], state.q[0], 1e-8);
    double largest = 0.0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      for (int look = 0; look <= 20; ++look)
        largest = std::max(largest, std::abs(quintic(points[i], points[i + 1], 0,
                                                     0.05 * look * (points[i + 1].time - points[i].time))[2]));
    }
    EXPECT_NEAR(largest, most, 1e-4) << period;
  }
}

TEST(RosTrajectory, IsOneDocumentOfAnyArm) {
  const Exported exported;
  robot::ArmModel arm = exported.controller.arm();
  arm.links[static_cast<std::size_t>(robot::find_link(arm, "tool0"))].name = "mounting_plate";
  RobotProgram program{exported.plan, arm, test::start_joints(exported.controller), exported.for_robot().loads};
  EXPECT_THROW((void)format_ros_trajectory(exported.run, program, 0.04), InputError);
  program.flange = "mounting_plate";
  const std::string text = format_ros_trajectory(exported.run, program, 0.04);
  EXPECT_NE(text.find("# tool: p[0.000000, 0.000000, 0.335000,"), std::string::npos);
  EXPECT_NE(text.find("(TCP in mounting_plate:"), std::string::npos);
  EXPECT_EQ(text.find("\n---"), std::string::npos);
  EXPECT_NE(text.find("\nio:\n"), std::string::npos);
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
