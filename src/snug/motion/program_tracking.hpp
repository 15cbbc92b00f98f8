// Tracking of a program, and its robot: comments of its file say for which it was made.
#pragma once

#include <string>
#include <string_view>

#include "snug/motion/tracking.hpp"

namespace snug::motion {

/// For the head of a file: "# tempo: 0.8\n" of fast tracking, "# tracking: exact\n", nothing of lagged tracking: the
/// demonstrator's files say nothing.
[[nodiscard]] std::string format_tracking(const Tracking& tracking);
/// What the comments of a program's text say; lagged where they say nothing. Throws InputError with file and line for a
/// tempo that is no number from 0.1 to 1, a tracking that is neither lagged nor exact, for a second one of either, and
/// for a comment that is meant as one but misspelt ("# tmepo: 1", "# tempo = 1"). `name` stands for the file.
[[nodiscard]] Tracking find_tracking(std::string_view text, std::string_view name);

/// "# robot: ur10\n"; nothing of none.
[[nodiscard]] std::string format_robot(std::string_view robot);
/// Name of the robot that a comment says, a word without blanks (others are remarks); empty where none does. Throws
/// InputError with file and line for a second one.
[[nodiscard]] std::string find_robot(std::string_view text, std::string_view name);

}  // namespace snug::motion
