// A served UR read and compared with its own scenario, and with what differs from it.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "snug/core/input_error.hpp"
#include "snug/remote_ur/compare_robot.hpp"
#include "snug/remote_ur/rtde_client.hpp"
#include "snug/served_ur/test/served.hpp"

namespace snug::remote_ur {
namespace {

const cell::Simulation& served_cell() { return served_ur::test::demonstrator_cell(); }

using served_ur::test::Served;

Endpoint endpoint_of(const Served& served) {
  Endpoint endpoint;
  endpoint.port_offset = served.offset();
  return endpoint;
}

/// As a served cell says it, without sockets.
RobotReport report_of_cell() {
  const served_ur::UrArm arm(served_cell());
  RobotReport report;
  report.is_in_remote_control = true;
  report.state.robot_mode = 7;
  report.state.safety_mode = 1;
  report.state.tcp_offset = served_ur::to_values(arm.tool());
  report.state.robot = arm.facts();
  report.payload = arm.tool_load().mass;
  report.payload_cog = {arm.tool_load().com.x(), arm.tool_load().com.y(), arm.tool_load().com.z()};
  return report;
}

std::vector<std::string> differing(const RobotReport& report) {
  std::vector<std::string> names;
  for (const Finding& finding : compare_robot(report, served_cell().scenario()))
    if (finding.verdict == Verdict::Differs) {
      EXPECT_FALSE(finding.remedy.empty()) << finding.what;
      names.push_back(finding.what);
    }
  return names;
}

using Names = std::vector<std::string>;

TEST(RemoteUr, AServedCellFitsItsScenario) {
  const Served served;
  const RobotReport report = read_robot(endpoint_of(served));
  EXPECT_EQ(report.model, "UR10");
  EXPECT_EQ(report.version, ur::facts_of(ur::Model::Ur10).version);
  EXPECT_EQ(report.is_in_remote_control, true);
  EXPECT_EQ(report.state.robot_mode, 7);
  EXPECT_EQ(report.state.robot.dh_d, served_ur::UrArm(served_cell()).facts().dh_d);
  EXPECT_EQ(report.q, served_ur::to_values(served_cell().make_state().arm->machine.joints.q));
  ASSERT_TRUE(report.payload && report.payload_cog && report.tool_voltage);
  EXPECT_EQ(differing(report), Names{});
}

TEST(RemoteUr, OutputsThatOlderSoftwareLacksAreLeftOut) {
  const Served served;
  RtdeClient client(endpoint_of(served), {"no_such_output", "timestamp", "robot_mode", "actual_q"}, 125.0);
  EXPECT_EQ(client.unknown(), Names{"no_such_output"});
  const RtdeValues first = client.receive();
  const RtdeValues second = client.receive();
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first.at("robot_mode"), std::vector<double>{7.0});
  EXPECT_EQ(first.at("actual_q").size(), 6U);
  EXPECT_NEAR(second.at("timestamp")[0] - first.at("timestamp")[0], 0.008, 1e-9);
  EXPECT_THROW(RtdeClient(endpoint_of(served), {"no_such_output"}, 125.0), InputError);
}

TEST(RemoteUr, EachDifferenceIsFoundAndNamed) {
  const RobotReport fitting = report_of_cell();
  EXPECT_EQ(differing(fitting), Names{});
  RobotReport other = fitting;
  other.state.safety_mode = 3;
  other.state.robot_mode = 3;
  other.is_in_remote_control = false;
  other.state.is_program_running = true;
  other.state.speed_slider = 0.5;
  EXPECT_EQ(differing(other), (Names{"safety mode", "robot mode", "remote control", "program", "speed slider"}));
  other = fitting;
  other.state.robot.joint_speed[4] *= 0.5;
  other.state.robot.joint_max[2] -= 1.0;
  EXPECT_EQ(differing(other), (Names{"joint range", "joint speed"}));
  other = fitting;
  other.state.tcp_offset[2] += 0.0011;
  other.payload = *fitting.payload + 0.06;
  EXPECT_EQ(differing(other), (Names{"TCP", "payload"}));
  other = fitting;
  other.state.tcp_offset[2] += 0.0009;
  other.payload = *fitting.payload - 0.04;
  EXPECT_EQ(differing(other), Names{});
  other.payload_cog =
      ur::Values3{(*fitting.payload_cog)[0], (*fitting.payload_cog)[1] + 0.006, (*fitting.payload_cog)[2]};
  EXPECT_EQ(differing(other), Names{"payload"});
}

TEST(RemoteUr, KinematicsCompareByWhereTheToolIs) {
  const ur::RobotFacts facts = served_ur::UrArm(served_cell()).facts();
  const model::Scenario& scenario = served_cell().scenario();
  EXPECT_LT(kinematic_deviation(facts, scenario), 1e-9);
  ur::RobotFacts same = facts;  // axes 2 and 3 are parallel: calibrated robots have metres there
  same.dh_d[1] += 3.0;
  same.dh_d[2] -= 3.0;
  EXPECT_LT(kinematic_deviation(same, scenario), 1e-9);
  ur::RobotFacts raised = facts;  // the whole arm, by 2 mm
  raised.dh_d[0] += 0.002;
  EXPECT_NEAR(kinematic_deviation(raised, scenario), 0.002, 1e-9);
  ur::RobotFacts turned = facts;  // a joint's zero: off by the angle times the distance from its axis
  turned.dh_theta[0] += 0.01;
  EXPECT_GT(kinematic_deviation(turned, scenario), 0.005);
  EXPECT_LT(kinematic_deviation(turned, scenario), 0.02);
}

TEST(RemoteUr, NumbersThatAreNoneFitNothing) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RobotReport report = report_of_cell();
  report.state.robot.dh_a[1] = report.state.robot.joint_speed[0] = report.state.robot.joint_min[3] = kNone;
  report.state.tcp_offset[0] = kNone;
  report.state.speed_slider = kNone;
  report.payload = kNone;
  EXPECT_EQ(differing(report), (Names{"speed slider", "kinematics", "joint speed", "joint range", "TCP", "payload"}));
}

TEST(RemoteUr, WhatIsNotToldIsUnknown) {
  RobotReport report = report_of_cell();
  report.is_in_remote_control.reset();
  report.payload.reset();
  const std::vector<Finding> findings = compare_robot(report, served_cell().scenario());
  EXPECT_EQ(std::ranges::count(findings, Verdict::Unknown, &Finding::verdict), 2);
  EXPECT_EQ(std::ranges::count(findings, Verdict::Differs, &Finding::verdict), 0);
}

/// A port of this machine where somebody listens and never says a word.
struct SilentPort {
  SilentPort() : socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at = {};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    EXPECT_EQ(::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    port = ntohs(at.sin_port);
  }
  Descriptor socket;
  int port = 0;
};

TEST(RemoteUr, NobodyAndSilenceEndInTime) {
  SilentPort silent;
  const auto since = std::chrono::steady_clock::now();
  EXPECT_THROW((void)read_robot({"127.0.0.1", silent.port - 30001, 0.2}), InputError);  // bound, not listening
  ASSERT_EQ(::listen(silent.socket.get(), 4), 0);
  EXPECT_THROW((void)read_robot({"127.0.0.1", silent.port - 30001, 0.2}), InputError);
  EXPECT_THROW(RtdeClient({"127.0.0.1", silent.port - 30004, 0.2}, {"timestamp"}, 0.0), InputError);
  EXPECT_LT(std::chrono::steady_clock::now() - since, std::chrono::seconds(3));
  EXPECT_THROW((void)read_robot({"no host", 0, 0.2}), InputError);
  EXPECT_THROW((void)read_robot({"127.0.0.1", 60000, 0.2}), InputError);
}

}  // namespace
}  // namespace snug::remote_ur
