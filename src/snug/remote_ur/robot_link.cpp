// RobotLink: what a plant and the program of ours on the robot tell each other.
#include "snug/remote_ur/robot_link.hpp"

#include <algorithm>

namespace snug::remote_ur {

std::array<std::int32_t, 3> RobotCommand::integers() const {
  return {count, static_cast<std::int32_t>(mode), payload_count};
}

std::array<double, 22> RobotCommand::numbers() const {
  std::array<double, 22> numbers{};
  auto at = numbers.begin();
  for (const ur::Values6& target : q) at = std::ranges::copy(target, at).out;
  *at++ = payload;
  std::ranges::copy(payload_cog, at);
  return numbers;
}

}  // namespace snug::remote_ur
