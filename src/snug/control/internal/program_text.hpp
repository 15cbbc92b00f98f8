// Parts of text that programs for real robots have in common: comments at their head, poses, loads.
#pragma once

#include <optional>
#include <string>

#include "snug/control/robot_program.hpp"

namespace snug::control::internal {

/// Pose of a link in W with all joints at 0: that of a link which no joint moves. Throws InputError without the link.
[[nodiscard]] Pose pose_at_zero(const robot::ArmModel& arm, const std::string& link);

/// "p[x, y, z, rx, ry, rz]": m, rotation vector in rad.
[[nodiscard]] std::string format_pose(const Pose& X);
/// "[a, b, ...]"; `digits`: that count.
[[nodiscard]] std::string format_list(const robot::JointVector& values, int digits = 9);
/// Text that can stand between the quotes of a script or of YAML.
[[nodiscard]] std::string quotable(const std::string& text);

/// Gripper and what it carries, in the frame of the flange. Throws InputError where the arm has no such link.
[[nodiscard]] SpatialInertia payload_of(const RobotProgram& program, const std::optional<CarriedLoad>& load);
/// A line: set_payload of the gripper and what it carries: kg, and the centre of mass in the flange's frame, m.
[[nodiscard]] std::string format_payload(const RobotProgram& program, const std::optional<CarriedLoad>& load);
/// Pose of the cup's TCP in the flange's frame.
[[nodiscard]] std::string format_tcp(const RobotProgram& program);
/// Comments: what it was made of, units, tool, and the loads that it carries with the rows they are carried on the way
/// to.
[[nodiscard]] std::string format_header(const RobotProgram& program, const std::string& units);

}  // namespace snug::control::internal
