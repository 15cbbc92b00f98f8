// The reader of the primary port beside the writer, whose bytes are tested apart, and against mutated packets.
#include "snug/ur/primary_reader.hpp"

#include <gtest/gtest.h>

#include <string>

#include "snug/core/rng.hpp"
#include "snug/ur/primary.hpp"

namespace snug::ur {
namespace {

Values6 counted(double from) {
  Values6 values{};
  for (std::size_t j = 0; j < 6; ++j) values[j] = from + 0.125 * static_cast<double>(j);
  return values;
}

std::string some_state(Model model = Model::Ur10e) {
  RobotData data;
  data.robot_mode = RobotMode::Running;
  data.safety_mode = SafetyMode::ProtectiveStop;
  data.runtime_state = RuntimeState::Playing;
  data.target_speed_fraction = 0.25;
  data.digital_inputs = 0x20001;
  data.digital_outputs = 0x10002;
  data.tcp_offset = counted(1.0);
  data.actual_tcp_pose = counted(9.0);
  RobotFacts robot;
  robot.dh_theta = counted(2.0);
  robot.dh_a = counted(3.0);
  robot.dh_d = counted(4.0);
  robot.dh_alpha = counted(5.0);
  robot.joint_min = counted(-6.0);
  robot.joint_max = counted(6.0);
  robot.joint_speed = counted(7.0);
  robot.joint_acceleration = counted(8.0);
  return robot_state(data, robot, facts_of(model));
}

TEST(PrimaryReader, ReadsWhatWasWritten) {
  const auto state = read_robot_state(some_state());
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->is_program_running);
  EXPECT_FALSE(state->is_program_paused);
  EXPECT_EQ(state->robot_mode, 7);
  EXPECT_EQ(state->safety_mode, 3);
  EXPECT_EQ(state->speed_slider, 0.25);
  EXPECT_EQ(state->digital_inputs, 0x20001U);
  EXPECT_EQ(state->digital_outputs, 0x10002U);
  EXPECT_EQ(state->tcp_offset, counted(1.0));
  EXPECT_EQ(state->robot.dh_theta, counted(2.0));
  EXPECT_EQ(state->robot.dh_a, counted(3.0));
  EXPECT_EQ(state->robot.dh_d, counted(4.0));
  EXPECT_EQ(state->robot.dh_alpha, counted(5.0));
  EXPECT_EQ(state->robot.joint_min, counted(-6.0));
  EXPECT_EQ(state->robot.joint_max, counted(6.0));
  EXPECT_EQ(state->robot.joint_speed, counted(7.0));
  EXPECT_EQ(state->robot.joint_acceleration, counted(8.0));
  EXPECT_EQ(state->robot_type, 2);
  EXPECT_EQ(state->control_box, 4);
  EXPECT_STREQ(robot_mode_name(state->robot_mode), "RUNNING");
  EXPECT_STREQ(safety_mode_name(state->safety_mode), "PROTECTIVE_STOP");
  EXPECT_STREQ(robot_mode_name(99), "UNKNOWN");
  EXPECT_STREQ(safety_mode_name(0), "UNKNOWN");
  const auto old = read_robot_state(some_state(Model::Ur10));
  ASSERT_TRUE(old);  // without the byte at the end of its mode
  EXPECT_EQ(old->control_box, 3);
}

TEST(PrimaryReader, VersionsAndPacketsOfOtherKinds) {
  const std::string version = version_message(1.0, facts_of(Model::Ur10e));
  const auto read = read_version(version);
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, facts_of(Model::Ur10e).version);
  EXPECT_FALSE(read_robot_state(version));
  EXPECT_FALSE(read_version(some_state()));
  EXPECT_FALSE(read_version(key_message(1.0, "PROGRAM_XXX_STARTED", "a")));
}

TEST(PrimaryReader, PacketsAreToldApart) {
  const std::string state = some_state(), stream = state + "more";  // a packet is a view of the stream
  const NextPacket next = next_packet(stream);
  ASSERT_TRUE(next.packet);
  EXPECT_EQ(*next.packet, state);
  EXPECT_FALSE(next_packet(state.substr(0, state.size() - 1)).packet);
  EXPECT_FALSE(next_packet("").is_broken);
  EXPECT_TRUE(next_packet(std::string(5, '\0')).is_broken);
  EXPECT_TRUE(next_packet("GET / HTTP/1.1").is_broken);
}

TEST(PrimaryReader, MutatedPacketsAreReadOrRefused) {
  const std::string whole = some_state();
  Rng rng(11);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string packet = whole;
    for (std::uint64_t n = 1 + rng.next() % 4; n > 0; --n)
      packet[static_cast<std::size_t>(rng.index(static_cast<int>(packet.size())))] = static_cast<char>(rng.next());
    if (rng.next() % 4 == 0) packet.resize(static_cast<std::size_t>(rng.index(static_cast<int>(packet.size()))));
    refused += read_robot_state(packet) ? 0 : 1;
    (void)read_version(packet);
    (void)next_packet(packet);
  }
  EXPECT_GT(refused, 2000);   // a quarter is cut
  EXPECT_LT(refused, 15000);  // most bytes are numbers
}

TEST(PrimaryReader, ReadsWhyAProgramFailed) {
  const std::string packet = runtime_exception(1.5, 7, 3, "name 'x' is not defined");
  const auto exception = read_runtime_exception(packet);
  ASSERT_TRUE(exception);
  EXPECT_EQ(exception->line, 7);
  EXPECT_EQ(exception->text, "name 'x' is not defined");
  EXPECT_FALSE(read_runtime_exception(text_message(1.5, "hello")));
  for (std::size_t length = 0; length < packet.size(); ++length)
    EXPECT_FALSE(read_runtime_exception(packet.substr(0, length))) << length;
}

}  // namespace
}  // namespace snug::ur
