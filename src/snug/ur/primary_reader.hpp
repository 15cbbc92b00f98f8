// Packets of the primary port (30001) of a UR controller, read: what the robot is, and what it does now.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "snug/ur/robot_data.hpp"

namespace snug::ur {

/// The packet at the beginning of `bytes`, none when it is not whole yet. Broken: a size that no packet has; what
/// follows cannot be read.
struct NextPacket {
  std::optional<std::string_view> packet;  ///< with its size and type
  bool is_broken = false;
};
inline constexpr std::size_t kLargestPacket = 65536;
[[nodiscard]] NextPacket next_packet(std::string_view bytes);

/// Of a robot state. Modes are numbers as the controller sends them: there are more than RobotMode and SafetyMode name.
struct PrimaryState {
  bool is_program_running = false, is_program_paused = false;
  int robot_mode = -1, safety_mode = 0;
  double speed_slider = 1.0;                              ///< 0 .. 1
  std::uint32_t digital_inputs = 0, digital_outputs = 0;  ///< bits as in RobotData
  Values6 tcp_offset{};                                   ///< of the TCP in the flange
  RobotFacts robot;                                       ///< DH with the robot's own calibration, limits
  int robot_type = 0;                                     ///< 1 UR5, 2 UR10, 3 UR3
  int control_box = 0;                                    ///< 3 CB3, 4 and 5 e-Series
};
/// None for another packet, and for a state that lacks one of the parts above. Numbers may be anything, NaN too.
[[nodiscard]] std::optional<PrimaryState> read_robot_state(std::string_view packet);
/// Major, minor, bugfix, build of a version message; none for another packet.
[[nodiscard]] std::optional<std::array<std::uint32_t, 4>> read_version(std::string_view packet);

/// Line, from 1, and text of a runtime exception; none for another packet. The text may be anything.
struct RuntimeException {
  int line = 0;
  std::string text;
};
[[nodiscard]] std::optional<RuntimeException> read_runtime_exception(std::string_view packet);

/// "RUNNING", "PROTECTIVE_STOP", .., as the dashboard says them; "UNKNOWN" for other numbers.
[[nodiscard]] const char* robot_mode_name(int mode);
[[nodiscard]] const char* safety_mode_name(int mode);

}  // namespace snug::ur
