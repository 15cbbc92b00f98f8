// calibrate: what measurements say about the arm, its tool and its sensor, written where scenarios read it.
#pragma once

#include <optional>
#include <string>

#include "verb.hpp"

namespace snug::app {

struct CalibrateKinematicsOptions {
  std::string urdf;  ///< nominal; empty: the shipped UR10
  std::optional<std::string> deltas;
  std::optional<std::string> yaml;
  std::string angles = "urdf";
  std::optional<std::string> output;
  std::optional<std::string> yaml_output;
  bool json = false;
};

void add_calibrate(CLI::App& app, Action& action);
[[nodiscard]] int run_calibrate_kinematics(const CalibrateKinematicsOptions& options);

}  // namespace snug::app
