// Packets of the primary (30001), secondary (30002) and real-time (30003) ports of a UR controller.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "snug/ur/robot_data.hpp"

namespace snug::ur {

/// Numbers as the controller sends them.
enum class PacketType : std::uint8_t { RobotState = 16, RobotMessage = 20 };
enum class MessageType : std::uint8_t {
  Text = 0,
  Version = 3,
  SafetyMode = 5,
  Error = 6,
  Key = 7,
  RuntimeException = 10
};

/// The state of the robot with all its parts: mode, joints, tool, master board, Cartesian, kinematics, configuration,
/// force, additional. Below 2000 bytes.
[[nodiscard]] std::string robot_state(const RobotData& data, const RobotFacts& robot, const ModelFacts& model);

/// `time`: s since the controller started.
[[nodiscard]] std::string version_message(double time, const ModelFacts& model);
/// `title`: PROGRAM_XXX_STARTED and the like; `text`: the program's name.
[[nodiscard]] std::string key_message(double time, std::string_view title, std::string_view text);
/// Lines and columns count from 1; 0 where there is none.
[[nodiscard]] std::string runtime_exception(double time, int line, int column, std::string_view text);
/// textmsg(); `text` may have several lines.
[[nodiscard]] std::string text_message(double time, std::string_view text);
/// Code `C<code>A<argument>`; `level`: 1 information, 2 warning, 3 violation, 4 fault.
[[nodiscard]] std::string error_message(double time, int code, int argument, int level, std::string_view text);
[[nodiscard]] std::string safety_mode_message(double time, SafetyMode mode);

inline constexpr std::size_t kRealTimeSize = 1140;
/// The packet of port 30003, kRealTimeSize bytes: that of software 3.14 and 5.9.
[[nodiscard]] std::string real_time_state(const RobotData& data);

}  // namespace snug::ur
