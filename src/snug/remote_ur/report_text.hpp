// What a UR controller says of itself and what of it does not fit, as text: lines for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "snug/model/robot_io.hpp"
#include "snug/remote_ur/compare_robot.hpp"

namespace snug::remote_ur {

/// Whether nothing of it is known to differ.
[[nodiscard]] bool fits(const std::vector<Finding>& findings);
/// `io`: how the scenario has it wired.
[[nodiscard]] std::string format_text(const RobotReport& robot, const std::vector<Finding>& findings,
                                      const model::RobotIo& io);
/// One line.
[[nodiscard]] std::string format_json(const RobotReport& robot, const std::vector<Finding>& findings);

}  // namespace snug::remote_ur
