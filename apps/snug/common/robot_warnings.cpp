// What a user should know about the file of the robot that a verb works with.
#include "apps/snug/common/robot_warnings.hpp"

#include "apps/snug/command_line/outputs.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/robot/urdf_warnings.hpp"

namespace snug::app {

void print_robot_warnings(const model::Scenario& scenario) {
  if (!scenario.robot) return;
  const std::filesystem::path urdf = robot::urdf_path(scenario);
  print_warnings(robot::find_assumptions(urdf, scenario.robot->tool_frame));
  print_warnings(robot::find_unknown_efforts(urdf));
  print_warnings(robot::find_weak_joints(scenario));
}

}  // namespace snug::app
