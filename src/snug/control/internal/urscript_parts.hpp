// Parts of scripts for the controller of a UR robot that all forms of them have.
#pragma once

#include <optional>
#include <string>

#include "snug/control/urscript.hpp"

namespace snug::control::internal {

/// rad/s^2, what movej has when nothing is said.
inline constexpr double kJointAcceleration = 1.4;

/// URScript runs on the controllers of one maker: throws InputError for an arm with other axes, joint names or links.
void check_is_ur(const robot::ArmModel& arm);

/// Outputs of what changes; of both when nothing is known of them before.
[[nodiscard]] std::string format_outputs(const std::optional<motion::IO>& before, const motion::IO& io,
                                         const UrScriptOptions& options);
/// The functions that waits call. Throws InputError where nothing tells of the vacuum.
[[nodiscard]] std::string wait_function(const UrScriptOptions& options);
/// The wait until the input says that the vacuum is what the waypoint wants.
[[nodiscard]] std::string format_wait(const motion::Waypoint& waypoint);
/// The wait until a box stands at the aligner, for that waypoint; nothing where no input says so.
[[nodiscard]] std::string format_part_wait(const motion::Waypoint& waypoint, const UrScriptOptions& options);
/// A line: payload of gripper and load.
[[nodiscard]] std::string format_script_payload(const RobotProgram& program, const std::optional<CarriedLoad>& load,
                                                const UrScriptOptions& options);
/// Tool and payload, and the way to the joints where the program begins.
[[nodiscard]] std::string format_start(const RobotProgram& program, const robot::JointVector& q,
                                       const UrScriptOptions& options);

}  // namespace snug::control::internal
