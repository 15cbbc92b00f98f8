// Packets of the primary port (30001) of a UR controller, read: what the robot is, and what it does now.
#include "snug/ur/primary_reader.hpp"

#include "snug/ur/bytes.hpp"
#include "snug/ur/primary.hpp"

namespace snug::ur {
namespace {

Values6 read_six(ByteReader& in) {
  Values6 values{};
  for (double& value : values) value = in.f64();
  return values;
}

void skip(ByteReader& in, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) (void)in.u8();
}

bool read_mode(ByteReader in, PrimaryState& state) {
  skip(in, 8 + 5);  // time; real robot connected, enabled, power on, emergency stop, protective stop
  state.is_program_running = in.u8() != 0;
  state.is_program_paused = in.u8() != 0;
  state.robot_mode = in.u8();
  if (state.robot_mode == 255) state.robot_mode = -1;
  skip(in, 1);  // control mode
  state.speed_slider = in.f64();
  return in.is_good();
}

bool read_master_board(ByteReader in, PrimaryState& state) {
  state.digital_inputs = in.u32();
  state.digital_outputs = in.u32();
  skip(in, 2 + 16 + 2 + 16 + 16);  // analog inputs and outputs; temperature, voltage, currents
  state.safety_mode = in.u8();
  return in.is_good();
}

bool read_cartesian(ByteReader in, PrimaryState& state) {
  (void)read_six(in);  // the pose of the TCP
  state.tcp_offset = read_six(in);
  return in.is_good();
}

bool read_kinematics(ByteReader in, PrimaryState& state) {
  skip(in, 6 * 4);  // checksums
  for (Values6* row : {&state.robot.dh_theta, &state.robot.dh_a, &state.robot.dh_d, &state.robot.dh_alpha})
    *row = read_six(in);
  return in.is_good();
}

bool read_configuration(ByteReader in, PrimaryState& state) {
  for (std::size_t j = 0; j < 6; ++j) {
    state.robot.joint_min[j] = in.f64();
    state.robot.joint_max[j] = in.f64();
  }
  for (std::size_t j = 0; j < 6; ++j) {
    state.robot.joint_speed[j] = in.f64();
    state.robot.joint_acceleration[j] = in.f64();
  }
  skip(in, 5 * 8 + 4 * 6 * 8 + 4);  // defaults of motions, nominal DH, version of the master board
  state.control_box = in.i32();
  state.robot_type = in.i32();
  return in.is_good();
}

}  // namespace

NextPacket next_packet(std::string_view bytes) {
  if (bytes.size() < 5) return {};
  const std::size_t size = ByteReader(bytes).u32();
  if (size < 5 || size > kLargestPacket) return {std::nullopt, true};
  if (bytes.size() < size) return {};
  return {bytes.substr(0, size), false};
}

std::optional<PrimaryState> read_robot_state(std::string_view packet) {
  ByteReader in(packet);
  if (in.u32() != packet.size() || in.u8() != static_cast<std::uint8_t>(PacketType::RobotState)) return std::nullopt;
  PrimaryState state;
  constexpr unsigned kAll = 0b1111001;  // of the parts 0, 3, 4, 5, 6
  unsigned found = 0;
  while (!in.rest().empty()) {
    const std::size_t size = in.u32();
    const unsigned part = in.u8();
    if (!in.is_good() || size < 5 || in.rest().size() < size - 5) return std::nullopt;
    const ByteReader content(in.rest().substr(0, size - 5));
    skip(in, size - 5);
    const bool is_read = part == 0   ? read_mode(content, state)
                         : part == 3 ? read_master_board(content, state)
                         : part == 4 ? read_cartesian(content, state)
                         : part == 5 ? read_kinematics(content, state)
                         : part == 6 ? read_configuration(content, state)
                                     : false;
    if (is_read) found |= 1U << part;
  }
  if (found != kAll) return std::nullopt;
  return state;
}

std::optional<std::array<std::uint32_t, 4>> read_version(std::string_view packet) {
  ByteReader in(packet);
  if (in.u32() != packet.size() || in.u8() != static_cast<std::uint8_t>(PacketType::RobotMessage)) return std::nullopt;
  skip(in, 8 + 1);  // time, source
  if (in.u8() != static_cast<std::uint8_t>(MessageType::Version)) return std::nullopt;
  skip(in, in.u8());  // name of the project
  std::array<std::uint32_t, 4> version{};
  version[0] = in.u8();
  version[1] = in.u8();
  version[2] = in.u32();
  version[3] = in.u32();
  if (!in.is_good()) return std::nullopt;
  return version;
}

std::optional<RuntimeException> read_runtime_exception(std::string_view packet) {
  ByteReader in(packet);
  if (in.u32() != packet.size() || in.u8() != static_cast<std::uint8_t>(PacketType::RobotMessage)) return std::nullopt;
  skip(in, 8 + 1);  // time, source
  if (in.u8() != static_cast<std::uint8_t>(MessageType::RuntimeException)) return std::nullopt;
  RuntimeException exception;
  exception.line = in.i32();
  skip(in, 4);  // column
  if (!in.is_good()) return std::nullopt;
  exception.text = std::string(in.rest());
  return exception;
}

const char* robot_mode_name(int mode) {
  constexpr std::array kNames = {"NO_CONTROLLER", "DISCONNECTED", "CONFIRM_SAFETY", "BOOTING", "POWER_OFF",
                                 "POWER_ON",      "IDLE",         "BACKDRIVE",      "RUNNING", "UPDATING_FIRMWARE"};
  return mode >= -1 && mode <= 8 ? kNames[static_cast<std::size_t>(mode + 1)] : "UNKNOWN";
}

const char* safety_mode_name(int mode) {
  constexpr std::array kNames = {"NORMAL",
                                 "REDUCED",
                                 "PROTECTIVE_STOP",
                                 "RECOVERY",
                                 "SAFEGUARD_STOP",
                                 "SYSTEM_EMERGENCY_STOP",
                                 "ROBOT_EMERGENCY_STOP",
                                 "VIOLATION",
                                 "FAULT"};
  return mode >= 1 && mode <= 9 ? kNames[static_cast<std::size_t>(mode - 1)] : "UNKNOWN";
}

}  // namespace snug::ur
