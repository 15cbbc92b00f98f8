// calibrate: what measurements say about the arm, its tool and its sensor, written where scenarios read it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

/// What all parts of the verb have.
struct CalibrateOptions {
  std::string urdf;  ///< nominal; empty: the shipped UR10
  std::string tool_frame = "E";
  std::optional<std::string> output;
  bool json = false;
};

struct CalibrateKinematicsOptions : CalibrateOptions {
  std::optional<std::string> deltas;
  std::optional<std::string> yaml;
  std::optional<std::string> poses;
  std::string angles = "urdf";
  std::string base = "base";  ///< link that poses are measured in
  std::string end = "tool0";  ///< link that is measured
  std::optional<std::string> yaml_output;
};

struct CalibrateToolOptions : CalibrateOptions {
  std::string input;
  std::string flange = "tool0";                 ///< link whose poses are given
  std::vector<double> tip_in_tool = {0, 0, 0};  ///< m, tip of the cone in E
};

struct CalibrateSensorOptions : CalibrateOptions {
  std::string input;
  std::string sensor = "ft_sensor";
  std::optional<double> mass;  ///< kg
};

struct CalibrateCameraOptions {
  std::string input;
  std::optional<std::string> output;  ///< block for a scenario (YAML)
  std::string name = "tote";
  std::string preset = "structured_light";
  bool json = false;
};

void add_calibrate(CLI::App& app, Action& action);
[[nodiscard]] int run_calibrate_kinematics(const CalibrateKinematicsOptions& options);
[[nodiscard]] int run_calibrate_camera(const CalibrateCameraOptions& options);
[[nodiscard]] int run_calibrate_tool(const CalibrateToolOptions& options);
[[nodiscard]] int run_calibrate_sensor(const CalibrateSensorOptions& options);

}  // namespace snug::app
