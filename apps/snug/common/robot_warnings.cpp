// What a user should know about the file of the robot that a verb works with.
#include "apps/snug/common/robot_warnings.hpp"

#include <cstdio>

#include "snug/robot/load_arm.hpp"

namespace snug::app {

void print_robot_warnings(const model::Scenario& scenario) {
  if (!scenario.robot) return;
  for (const std::string& warning : robot::find_unknown_efforts(robot::urdf_path(scenario))) {
    std::fprintf(stderr, "snug: warning: %s\n", warning.c_str());
  }
}

}  // namespace snug::app
