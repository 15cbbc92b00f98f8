// follow_script: the program of ours on the robot: its joints follow targets that a client writes into registers.
#pragma once

#include <cstdint>
#include <string>

#include "snug/served_ur/ur_arm.hpp"

namespace snug::remote_ur {

/// s, without a new command: the arm goes on for kCoast as it went, comes to rest within kFade, and the program ends.
/// Joints that brake with 12 rad/s^2 follow that from 1.6 rad/s; docs/ur.md adds up what it takes at most.
inline constexpr double kCoast = 0.016;
inline constexpr double kFade = 0.135;

/// A URScript program. It sets the TCP to frame E and the payload to the gripper, then reads and judges a target each
/// period, as RobotCommand says, while a thread of it leads the joints there (servoj, which a slow slider makes last
/// longer than a period); docs/ur.md has the registers. `zeroes`: it zeroes the force sensor first,
/// which software before 5 does not know. `number`: script_word().
[[nodiscard]] std::string follow_script(const served_ur::UrArm& arm, bool zeroes, std::int32_t number);

}  // namespace snug::remote_ur
