// The demonstrator's arm and controller, for the tests of this module.
#pragma once

#include <filesystem>
#include <string>

#include "snug/control/joint_controller.hpp"
#include "snug/control/pose_solver.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/controller.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::control::test {

inline const model::Scenario& demonstrator() {
  static const model::Scenario scenario =
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios" / "box-demonstrator.yaml");
  return scenario;
}

inline JointController make_controller(const model::RobotParams& params, double stiffness = 10.0) {
  return {robot::load_arm(demonstrator()), {0.008, stiffness, params, {}, "test"}};
}

/// At the speeds of the demonstrator's own controller.
inline JointController make_controller(double stiffness = 10.0) {
  model::RobotParams params = *demonstrator().robot;
  params.velocity_fraction = demonstrator().controller.velocity_fraction;
  return make_controller(params, stiffness);
}

inline robot::JointVector start_joints(const JointController& controller) {
  const robot::JointVector posture = robot::joint_vector(controller.settings().params.posture);
  return solve_pose(controller.arm(), demonstrator().controller.X_WE_start, posture).q;
}

inline motion::ControllerSettings program_settings(const motion::Tracking& tracking, double stiffness = 10.0) {
  motion::ControllerSettings settings;
  settings.tracking = tracking;
  settings.task_stiffness = stiffness;
  for (const model::MoveLimits& limits : demonstrator().controller.limits) {
    settings.limits.push_back({limits.prefix,
                               {limits.precision, limits.max_acceleration, limits.max_speed, limits.max_turn_speed,
                                limits.max_turn_acceleration}});
  }
  return settings;
}

}  // namespace snug::control::test
