// Messages: what is written is read back; what is no message is refused with a reason.
#include "snug/click/message.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace snug::click {
namespace {

Message read_back(const Message& message) {
  const auto decoded = decode(encode(message));
  EXPECT_TRUE(decoded.has_value()) << decoded.error();
  return *decoded;
}

Handshake a_handshake() {
  Handshake handshake;
  handshake.time_step = 0.008;
  ObjectDescription& robot = handshake.objects["robot"];
  robot.controls = {"a", "b"};
  robot.control_types = {ValueType::Angle, ValueType::Torque1D};
  robot.joints = {"b", "a"};
  robot.joint_sensors = {ValueType::Angle, ValueType::AngularVelocity1D, ValueType::Torque1D, ValueType::Force3D};
  robot.events = {{"vacuum", ValueType::Activated}};
  robot.sensors = {{"force", {ValueType::Force3D, ValueType::Torque3D}}};
  handshake.objects["box"].object_sensors = {ValueType::Position, ValueType::Rpy};
  return handshake;
}

Sensor a_sensor() {
  Sensor sensor;
  sensor.time = 1.25;
  ObjectSensors& robot = sensor.objects["robot"];
  robot.angles = {0.1, -0.0};
  robot.velocities = {std::numeric_limits<double>::denorm_min(), 1e300};
  robot.torques = {1.0, 2.0};
  robot.forces = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  for (const ValueType type :
       {ValueType::Position, ValueType::Rpy, ValueType::Acceleration3D, ValueType::Force3D, ValueType::Torque3D,
        ValueType::AngularAcceleration3D, ValueType::Velocity3D, ValueType::AngularVelocity3D}) {
    robot.object.push_back({type, {1.0, 2.0, static_cast<double>(type)}, 0.0, false});
  }
  for (const ValueType type :
       {ValueType::Angle, ValueType::AngularVelocity1D, ValueType::Torque1D, ValueType::Force1D}) {
    robot.sensors["scalars"].push_back({type, Vector3::Zero(), 0.5 + static_cast<double>(type), false});
  }
  robot.sensors["switch"] = {{ValueType::Activated, Vector3::Zero(), 0.0, true}};
  return sensor;
}

TEST(Message, IsReadBackAsItWasWritten) {
  Control control;
  control.objects["robot"] = {CommandList::Values, {1.0 / 3.0, -2.0}, {{"vacuum", true}, {"blow_off", false}}};
  control.objects["old"] = {CommandList::Torques, {3.0}, {}};
  for (const Message& message :
       {Message(HandshakeInit{}), Message(a_handshake()), Message(control), Message(a_sensor()), Message(Reset{}),
        Message(SensorRequest{}), Message(Error{"not so"})}) {
    EXPECT_EQ(read_back(message), message) << name_of(message);
  }
}

TEST(Message, HasTheBytesOfTheProtocol) {
  EXPECT_EQ(encode(HandshakeInit{}), std::string("\x10\x01", 2));  // type 0 is not written: the default
  EXPECT_EQ(encode(SensorRequest{}), std::string("\x08\x06", 2));
  EXPECT_EQ(encode(Reset{}), std::string("\x08\x04", 2));
  EXPECT_EQ(encode(Error{"no"}), std::string("\x08\x05\x1a\x02no", 6));
  Control control;
  control.objects["r"] = {CommandList::Values, {1.0}, {}};
  // field 2 {key "r", value {field 5, packed: one double}}
  const std::string one("\x00\x00\x00\x00\x00\x00\xf0\x3f", 8);
  EXPECT_EQ(encode(control), std::string("\x08\x02\x12\x0f\x0a\x01r\x12\x0a\x2a\x08", 11) + one);
}

TEST(Message, KeepsNumbersThatAreNotFinite) {
  Control control;
  control.objects["robot"] = {CommandList::Values, {std::nan(""), -std::numeric_limits<double>::infinity()}, {}};
  const Message message = read_back(control);
  EXPECT_TRUE(std::isnan(std::get<Control>(message).objects.at("robot").values[0]));
}

TEST(Message, TakesTheSceneWideTypeOfOlderServers) {
  Handshake handshake;
  handshake.objects["robot"].controls = {"a", "b"};
  // controlType 2 (field 3), and an object without types of its own
  const auto decoded = decode(std::string("\x08\x01\x18\x02\x22\x07\x0a\x01r\x12\x02\x0a\x00", 13));
  ASSERT_TRUE(decoded.has_value()) << decoded.error();
  EXPECT_EQ(std::get<Handshake>(*decoded).objects.at("r").control_types, std::vector<ValueType>{ValueType::Torque1D});
}

TEST(Message, RefusesWhatIsNone) {
  const auto reason_of = [](const std::string& frame) {
    const auto decoded = decode(frame);
    return decoded ? "read as " + std::string(name_of(*decoded)) : decoded.error();
  };
  EXPECT_NE(reason_of("\xff\xff\xff\xff").find("cannot be read"), std::string::npos);
  EXPECT_NE(reason_of(std::string("\x08\x63", 2)).find("type 99"), std::string::npos);
  // a Control whose length points behind its end
  EXPECT_NE(reason_of(std::string("\x08\x02\x12\x7f", 4)).find("cannot be read"), std::string::npos);
  // angles and torques at once: {1: [0.0], 3: [0.0]}
  const std::string zero(8, '\0');
  EXPECT_NE(reason_of(std::string("\x08\x02\x12\x19\x0a\x01r\x12\x14\x0a\x08", 11) + zero + "\x1a\x08" + zero)
                .find("more than one list"),
            std::string::npos);
  // an empty frame is a HandshakeInit of version 0
  const auto empty = decode("");
  ASSERT_TRUE(empty.has_value());
  EXPECT_EQ(std::get<HandshakeInit>(*empty).version, 0);
}

}  // namespace
}  // namespace snug::click
