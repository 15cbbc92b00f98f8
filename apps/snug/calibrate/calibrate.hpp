// calibrate: what measurements say about the arm, its tool and its sensor, written where scenarios read it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"
#include "snug/robot/arm.hpp"

namespace snug::app {

/// What all parts of the verb have.
struct CalibrateOptions {
  std::string urdf;  ///< nominal; empty: the shipped UR10
  std::string tool_frame = "E";
  std::optional<std::string> output;
  bool json = false;
};

/// --urdf, --tool-frame, -o (`output` says what that is) and --json.
void add_arm_options(const Verb& part, CalibrateOptions& options, const char* output);

struct NominalArm {
  std::filesystem::path path;
  robot::ArmModel arm;
  std::filesystem::path out_folder;  ///< of the URDF to be written
};

[[nodiscard]] NominalArm load_nominal(const CalibrateOptions& options);

/// The parts of the verb.
void add_calibrate_kinematics(const Verb& verb);
void add_calibrate_tool(const Verb& verb);
void add_calibrate_sensor(const Verb& verb);
void add_calibrate_camera(const Verb& verb);

}  // namespace snug::app
