// load_arm: the arm that a scenario names, standing where the scenario puts it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/robot/arm.hpp"

namespace snug::robot {

/// Loads scenario.robot's URDF (relative to the scenario file) and checks what the scenario says about it: frames and
/// links by name, one number in posture for each joint, within the limits. With `tool_pose` the arm has a link E more,
/// with the mass of the scenario's tool; joints of find_weak_joints have an effort of infinity. InputError otherwise,
/// and without a robot.
[[nodiscard]] ArmModel load_arm(const model::Scenario& scenario);

/// Where the URDF of scenario.robot is; there must be a robot.
[[nodiscard]] std::filesystem::path urdf_path(const model::Scenario& scenario);

/// Moving joints of a URDF whose limit has effort 0, as many public files have that do not know it: "file:line: joint
/// 'x': ...", a warning for each. Such a joint has Joint::max_effort infinity.
[[nodiscard]] std::vector<std::string> find_unknown_efforts(const std::filesystem::path& path);

/// Joints whose effort in the URDF is less than what the arm needs to hold itself, standing in its posture, and those
/// with the same number, as some public files have for all that nobody knew: a warning for each. Throws as load_arm.
[[nodiscard]] std::vector<std::string> find_weak_joints(const model::Scenario& scenario);

/// Joint values of a list, which load_arm has checked.
[[nodiscard]] JointVector joint_vector(const std::vector<double>& values);

}  // namespace snug::robot
