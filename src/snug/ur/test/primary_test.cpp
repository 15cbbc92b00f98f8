// Packets of the primary and real-time ports, beside bytes computed by hand and the sizes that clients know.
#include "snug/ur/primary.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "snug/ur/bytes.hpp"

namespace snug::ur {
namespace {

RobotData some_data() {
  RobotData data;
  data.timestamp = 1.5;
  data.robot_mode = RobotMode::Running;
  for (std::size_t j = 0; j < 6; ++j) data.actual_q[j] = static_cast<double>(j) + 0.25;
  return data;
}

/// Content of each part of a robot state by its type.
std::map<int, std::string> parts_of(const std::string& packet) {
  ByteReader in(packet);
  EXPECT_EQ(in.u32(), packet.size());
  EXPECT_EQ(in.u8(), 16);
  std::map<int, std::string> parts;
  while (!in.rest().empty()) {
    const std::size_t size = in.u32();
    const int type = in.u8();
    if (size < 5 || in.rest().size() < size - 5) {
      ADD_FAILURE() << "part " << type << " of " << size << " bytes";
      break;
    }
    parts[type] = std::string(in.rest().substr(0, size - 5));
    for (std::size_t i = 5; i < size; ++i) (void)in.u8();
  }
  return parts;
}

TEST(Primary, PartsHaveTheSizesThatClientsExpect) {
  for (const Model model : {Model::Ur10, Model::Ur10e, Model::Ur5e, Model::Ur20}) {
    const ModelFacts& facts = facts_of(model);
    const std::string packet = robot_state(some_data(), RobotFacts{}, facts);
    EXPECT_LT(packet.size(), 2000U);
    const std::map<int, std::string> parts = parts_of(packet);
    ASSERT_EQ(parts.size(), 9U);
    EXPECT_EQ(parts.at(0).size() + 5, facts.is_e_series ? 47U : 46U);
    EXPECT_EQ(parts.at(1).size() + 5, 251U);
    EXPECT_EQ(parts.at(2).size() + 5, 37U);
    EXPECT_EQ(parts.at(3).size() + 5, 75U);
    EXPECT_EQ(parts.at(4).size() + 5, 101U);
    EXPECT_EQ(parts.at(5).size() + 5, 225U);
    EXPECT_EQ(parts.at(6).size() + 5, 445U);
    EXPECT_EQ(parts.at(7).size() + 5, 61U);
  }
}

TEST(Primary, ModeHasTheBytesComputedByHand) {
  RobotData data = some_data();
  data.runtime_state = RuntimeState::Playing;
  data.target_speed_fraction = 0.5;
  const std::string mode = parts_of(robot_state(data, RobotFacts{}, facts_of(Model::Ur10))).at(0);
  // 1.5 s = 1 500 000 us = 0x16e360; connected, enabled, power; no stops; running, not paused; mode 7, position control
  const std::string expected(
      "\x00\x00\x00\x00\x00\x16\xe3\x60\x01\x01\x01\x00\x00\x01\x00\x07\x00"
      "\x3f\xe0\x00\x00\x00\x00\x00\x00\x3f\xf0\x00\x00\x00\x00\x00\x00\x3f\xf0\x00\x00\x00\x00\x00\x00",
      41);
  EXPECT_EQ(mode, expected);
}

TEST(Primary, JointsComeInTheirOrder) {
  const std::string joints = parts_of(robot_state(some_data(), RobotFacts{}, facts_of(Model::Ur10))).at(1);
  for (std::size_t j = 0; j < 6; ++j) {
    ByteReader in(std::string_view(joints).substr(41 * j));
    EXPECT_EQ(in.f64(), static_cast<double>(j) + 0.25);
  }
}

TEST(Primary, KeyMessageHasTheBytesComputedByHand) {
  const std::string expected(
      "\x00\x00\x00\x1e\x14\x00\x00\x00\x00\x00\x00\x00\x01\xff\x07\x00\x00\x00\x00\x00\x00\x00\x00"
      "\x04TEST"
      "ab",
      30);
  EXPECT_EQ(key_message(1e-6, "TEST", "ab"), expected);
}

TEST(Primary, VersionIsThatOfTheModel) {
  const std::string message = version_message(0.0, facts_of(Model::Ur10e));
  EXPECT_EQ(message.substr(15, 10), "\x09URControl");
  EXPECT_EQ(message[25], 5);
  EXPECT_EQ(message[26], 9);
}

TEST(Primary, ExceptionsSayLineColumnAndText) {
  const std::string message = runtime_exception(0.0, 3, 7, "bad");
  EXPECT_EQ(message.size(), 5U + 10U + 8U + 3U);
  ByteReader in(std::string_view(message).substr(14));
  EXPECT_EQ(in.u8(), 10);
  EXPECT_EQ(in.i32(), 3);
  EXPECT_EQ(in.i32(), 7);
  EXPECT_EQ(in.rest(), "bad");
}

TEST(RealTime, HasItsSizeAndPlaces) {
  RobotData data = some_data();
  data.runtime_state = RuntimeState::Playing;
  data.actual_tcp_pose = {1, 2, 3, 4, 5, 6};
  const std::string packet = real_time_state(data);
  ASSERT_EQ(packet.size(), kRealTimeSize);
  const auto at = [&](std::size_t offset) { return ByteReader(std::string_view(packet).substr(offset)).f64(); };
  EXPECT_EQ(at(4), 1.5);
  EXPECT_EQ(at(252), 0.25);  // actual q of the first joint
  EXPECT_EQ(at(444), 1.0);   // pose of the TCP
  EXPECT_EQ(at(756), 7.0);   // mode
  EXPECT_EQ(at(812), 1.0);   // safety mode
  EXPECT_EQ(at(940), 1.0);   // speed scaling
  EXPECT_EQ(at(1052), 2.0);  // program state
}

}  // namespace
}  // namespace snug::ur
