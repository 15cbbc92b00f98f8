// Packets of the primary (30001), secondary (30002) and real-time (30003) ports of a UR controller.
#include "snug/ur/primary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/ur/bytes.hpp"

namespace snug::ur {
namespace {

// Parts of a robot state.
enum class Part : std::uint8_t {
  Mode = 0,
  Joints = 1,
  Tool = 2,
  MasterBoard = 3,
  Cartesian = 4,
  Kinematics = 5,
  Configuration = 6,
  Force = 7,
  Additional = 8
};

constexpr std::int8_t kNoSource = -1;  // of messages of the controller itself: the byte is -1

std::uint64_t microseconds(double time) { return static_cast<std::uint64_t>(std::llround(std::max(0.0, time) * 1e6)); }

void append_part(ByteWriter& packet, Part type, const ByteWriter& content) {
  packet.u32(static_cast<std::uint32_t>(content.bytes().size() + 5));
  packet.u8(static_cast<std::uint8_t>(type));
  packet.text(content.bytes());
}

std::string packet_of(PacketType type, const ByteWriter& content) {
  ByteWriter out;
  out.i32(static_cast<std::int32_t>(content.bytes().size() + 5));
  out.u8(static_cast<std::uint8_t>(type));
  out.text(content.bytes());
  return out.take();
}

ByteWriter begin_message(double time, MessageType type) {
  ByteWriter out;
  out.u64(microseconds(time));
  out.i8(kNoSource);
  out.u8(static_cast<std::uint8_t>(type));
  return out;
}

ByteWriter mode_part(const RobotData& data, const ModelFacts& model) {
  ByteWriter out;
  out.u64(microseconds(data.timestamp));
  out.boolean(true);  // a real robot is connected
  out.boolean(true);  // and enabled
  out.boolean(data.is_powered());
  out.boolean(false);  // emergency stop
  out.boolean(data.safety_mode == SafetyMode::ProtectiveStop);
  out.boolean(data.is_program_running());
  out.boolean(data.runtime_state == RuntimeState::Paused);
  out.u8(static_cast<std::uint8_t>(data.robot_mode));
  out.u8(0);  // control mode: position
  out.f64(data.target_speed_fraction);
  out.f64(data.speed_scaling);
  out.f64(1.0);                      // the most that may be asked for
  if (model.is_e_series) out.u8(0);  // reserved; controllers of the CB series end before it
  return out;
}

ByteWriter joints_part(const RobotData& data) {
  ByteWriter out;
  for (std::size_t j = 0; j < 6; ++j) {
    out.f64(data.actual_q[j]);
    out.f64(data.target_q[j]);
    out.f64(data.actual_qd[j]);
    out.f32(static_cast<float>(data.actual_current[j]));
    out.f32(static_cast<float>(data.is_powered() ? kSupplyVoltage : 0.0));
    out.f32(static_cast<float>(kTemperature));
    out.f32(0.0F);
    out.u8(static_cast<std::uint8_t>(data.joint_mode()));
  }
  return out;
}

ByteWriter tool_part(const RobotData& data) {
  ByteWriter out;
  out.u8(1);  // ranges of the analog inputs: 0 .. 10 V
  out.u8(1);
  for (const double volts : data.tool_analog_inputs) out.f64(volts);
  out.f32(static_cast<float>(data.is_powered() ? kSupplyVoltage : 0.0));
  out.u8(0);
  out.f32(0.0F);
  out.f32(static_cast<float>(kTemperature));
  out.u8(static_cast<std::uint8_t>(data.joint_mode()));
  return out;
}

ByteWriter master_board_part(const RobotData& data) {
  ByteWriter out;
  out.u32(static_cast<std::uint32_t>(data.digital_inputs));
  out.u32(static_cast<std::uint32_t>(data.digital_outputs));
  out.u8(1);  // ranges of the analog inputs: 0 .. 10 V
  out.u8(1);
  for (const double volts : data.analog_inputs) out.f64(volts);
  out.u8(1);  // domains of the analog outputs: volts
  out.u8(1);
  for (const double volts : data.analog_outputs) out.f64(volts);
  out.f32(static_cast<float>(kTemperature));
  out.f32(static_cast<float>(data.is_powered() ? kSupplyVoltage : 0.0));
  out.f32(0.0F);
  out.f32(0.0F);
  out.u8(static_cast<std::uint8_t>(data.safety_mode));
  out.u8(0);   // not in reduced mode
  out.u8(0);   // no Euromap
  out.u32(0);  // reserved
  out.u8(0);   // operational mode: none
  out.u8(0);   // three-position switch
  out.u8(0);   // reserved
  return out;
}

ByteWriter cartesian_part(const RobotData& data) {
  ByteWriter out;
  out.f64s(data.actual_tcp_pose);
  out.f64s(data.tcp_offset);
  return out;
}

std::uint32_t checksum_of(const RobotFacts& robot, std::size_t joint) {
  ByteWriter numbers;
  for (const Values6* row : {&robot.dh_theta, &robot.dh_a, &robot.dh_d, &robot.dh_alpha}) numbers.f64((*row)[joint]);
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char byte : numbers.bytes()) hash = (hash ^ static_cast<std::uint8_t>(byte)) * 16777619U;
  return hash;
}

ByteWriter kinematics_part(const RobotFacts& robot) {
  ByteWriter out;
  for (std::size_t j = 0; j < 6; ++j) out.u32(checksum_of(robot, j));
  for (const Values6* row : {&robot.dh_theta, &robot.dh_a, &robot.dh_d, &robot.dh_alpha}) out.f64s(*row);
  out.u32(2);  // calibration status: linearised, as of a calibrated robot
  return out;
}

ByteWriter configuration_part(const RobotFacts& robot, const ModelFacts& model) {
  ByteWriter out;
  for (std::size_t j = 0; j < 6; ++j) {
    out.f64(robot.joint_min[j]);
    out.f64(robot.joint_max[j]);
  }
  for (std::size_t j = 0; j < 6; ++j) {
    out.f64(robot.joint_speed[j]);
    out.f64(robot.joint_acceleration[j]);
  }
  for (const double value : {1.05, 1.4, 0.25, 1.2, 0.25}) out.f64(value);  // the defaults of motions
  for (const Values6* row : {&robot.dh_a, &robot.dh_d, &robot.dh_alpha, &robot.dh_theta}) out.f64s(*row);
  out.i32(4);                          // version of the master board
  out.i32(model.is_e_series ? 4 : 3);  // type of the control box
  out.i32(model.robot_type);
  out.i32(model.is_e_series ? 1 : 0);
  return out;
}

ByteWriter force_part(const RobotData& data) {
  ByteWriter out;
  out.f64s(data.actual_tcp_force);
  out.f64(0.0);  // dexterity
  return out;
}

ByteWriter additional_part() {
  ByteWriter out;
  out.boolean(false);  // teach button pressed
  out.boolean(false);  // and enabled
  out.boolean(false);
  out.u8(0);
  return out;
}

}  // namespace

std::string robot_state(const RobotData& data, const RobotFacts& robot, const ModelFacts& model) {
  ByteWriter out;
  append_part(out, Part::Mode, mode_part(data, model));
  append_part(out, Part::Joints, joints_part(data));
  append_part(out, Part::Tool, tool_part(data));
  append_part(out, Part::MasterBoard, master_board_part(data));
  append_part(out, Part::Cartesian, cartesian_part(data));
  append_part(out, Part::Kinematics, kinematics_part(robot));
  append_part(out, Part::Configuration, configuration_part(robot, model));
  append_part(out, Part::Force, force_part(data));
  append_part(out, Part::Additional, additional_part());
  return packet_of(PacketType::RobotState, out);
}

std::string version_message(double time, const ModelFacts& model) {
  ByteWriter out = begin_message(time, MessageType::Version);
  out.short_text("URControl");
  out.u8(static_cast<std::uint8_t>(model.version[0]));
  out.u8(static_cast<std::uint8_t>(model.version[1]));
  out.i32(static_cast<std::int32_t>(model.version[2]));
  out.i32(static_cast<std::int32_t>(model.version[3]));
  out.text("01-01-2020, 00:00:00");
  return packet_of(PacketType::RobotMessage, out);
}

std::string key_message(double time, std::string_view title, std::string_view text) {
  ByteWriter out = begin_message(time, MessageType::Key);
  out.i32(0);
  out.i32(0);
  out.short_text(title);
  out.text(text);
  return packet_of(PacketType::RobotMessage, out);
}

std::string runtime_exception(double time, int line, int column, std::string_view text) {
  ByteWriter out = begin_message(time, MessageType::RuntimeException);
  out.i32(line);
  out.i32(column);
  out.text(text);
  return packet_of(PacketType::RobotMessage, out);
}

std::string text_message(double time, std::string_view text) {
  ByteWriter out = begin_message(time, MessageType::Text);
  out.text(text);
  return packet_of(PacketType::RobotMessage, out);
}

std::string error_message(double time, int code, int argument, int level, std::string_view text) {
  ByteWriter out = begin_message(time, MessageType::Error);
  out.i32(code);
  out.i32(argument);
  out.i32(level);
  out.u32(0);  // type of the data that follows: none
  out.u32(0);
  out.text(text);
  return packet_of(PacketType::RobotMessage, out);
}

std::string safety_mode_message(double time, SafetyMode mode) {
  ByteWriter out = begin_message(time, MessageType::SafetyMode);
  out.i32(0);  // code
  out.i32(0);  // argument
  out.u8(static_cast<std::uint8_t>(mode));
  out.u32(0);  // type of the data that follows: none
  out.u32(0);
  return packet_of(PacketType::RobotMessage, out);
}

std::string real_time_state(const RobotData& data) {
  ByteWriter out;
  const auto zeros = [&out](int count) {
    for (int i = 0; i < count; ++i) out.f64(0.0);
  };
  out.i32(static_cast<std::int32_t>(kRealTimeSize));
  out.f64(data.timestamp);
  for (const Values6* values :
       {&data.target_q, &data.target_qd, &data.target_qdd, &data.target_current, &data.target_moment, &data.actual_q,
        &data.actual_qd, &data.actual_current, &data.joint_control_output, &data.actual_tcp_pose,
        &data.actual_tcp_speed, &data.actual_tcp_force, &data.target_tcp_pose, &data.target_tcp_speed}) {
    out.f64s(*values);
  }
  out.f64(static_cast<double>(data.digital_inputs));
  for (int j = 0; j < 6; ++j) out.f64(kTemperature);
  out.f64(data.execution_time * 1e3);  // ms
  out.f64(0.0);                        // test value
  out.f64(static_cast<double>(data.robot_mode));
  for (int j = 0; j < 6; ++j) out.f64(data.joint_mode());
  out.f64(static_cast<double>(data.safety_mode));
  zeros(6);
  out.f64s(data.tool_acceleration);
  zeros(6);
  out.f64(data.speed_scaling);
  out.f64(data.momentum);
  zeros(2);
  out.f64(kSupplyVoltage);
  out.f64(data.is_powered() ? kSupplyVoltage : 0.0);
  out.f64(0.0);  // current of the robot
  for (int j = 0; j < 6; ++j) out.f64(data.is_powered() ? kSupplyVoltage : 0.0);
  out.f64(static_cast<double>(data.digital_outputs));
  out.f64(static_cast<double>(data.runtime_state));
  out.f64s(data.elbow_position);
  zeros(3);  // speed of the elbow
  out.f64(static_cast<double>(data.safety_mode));
  zeros(3);
  return out.take();
}

}  // namespace snug::ur
