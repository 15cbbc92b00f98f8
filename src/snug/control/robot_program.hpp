// RobotProgram: a program, the arm that is to do it, and what it carries: what exports are made of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/motion/controller.hpp"
#include "snug/robot/arm.hpp"

namespace snug::control {

/// What the cup holds on the way to a row, fixed to E.
struct CarriedLoad {
  double mass = 0.0;                    ///< kg
  Vector3 com_E = Vector3::Zero();      ///< m
  Matrix3 inertia_E = Matrix3::Zero();  ///< kg m^2, about its centre of mass, along the axes of E
  bool operator==(const CarriedLoad&) const = default;
};

/// A program, the robot that is to do it, and what it carries.
struct RobotProgram {
  const motion::PreparedProgram& plan;
  const robot::ArmModel& arm;
  robot::JointVector q_start;                     ///< from where the program begins
  std::vector<std::optional<CarriedLoad>> loads;  ///< one for each row
  /// What it was made of, a line each: program, sequence, version. Comments at the head of what is written.
  std::vector<std::string> notes = {};
  /// s, of the program as it was simulated, whose limits `plan` may have been fitted to; 0: that of `plan`.
  double simulated_duration = 0.0;
  std::string flange = "tool0";  ///< link on which the tool is mounted: payloads and the TCP are said in its frame
};

}  // namespace snug::control
