// What a user should know about the file of the robot that a verb works with.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::app {

/// Prints on stderr what the URDF of the scenario's robot leaves open, a line each; nothing without a robot.
void print_robot_warnings(const model::Scenario& scenario);

}  // namespace snug::app
