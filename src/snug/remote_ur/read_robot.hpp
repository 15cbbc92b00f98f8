// read_robot: what a UR controller says of itself and its robot, without moving or switching anything.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "snug/remote_ur/connection.hpp"
#include "snug/ur/primary_reader.hpp"

namespace snug::remote_ur {

/// SI, rad; frames as in ur::RobotData.
struct RobotReport {
  std::string model;                         ///< as the dashboard calls it, "UR10"; empty: it does not say
  std::array<std::uint32_t, 4> version{};    ///< of the software: major, minor, bugfix, build
  std::optional<bool> is_in_remote_control;  ///< none: it does not know the question (CB3)
  ur::PrimaryState state;
  std::optional<double> payload;           ///< kg; none: the software does not tell
  std::optional<ur::Values3> payload_cog;  ///< m, in the flange
  std::optional<double> tool_voltage;      ///< V, of the tool's analog input 0
  ur::Values6 q{};
};

/// From the primary port, RTDE and the dashboard. Throws InputError naming host and port for one that does not listen,
/// answer in time, or speak as a controller does.
[[nodiscard]] RobotReport read_robot(const Endpoint& endpoint);

}  // namespace snug::remote_ur
