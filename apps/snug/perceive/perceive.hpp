// perceive: where boxes of known size are, from one depth frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct PerceiveOptions {
  std::string frame;  ///< .png, .ply, .pcd or .h5
  std::string scenario;
  std::string expect;                      ///< placements (YAML)
  std::optional<std::string> camera;       ///< name; absent: the scenario's first
  std::vector<double> intrinsics;          ///< px: fx, fy, cx, cy; empty: the file's or the scenario's
  std::optional<double> depth_unit;        ///< m
  bool points_in_camera = false;           ///< PLY, PCD
  std::string axes = "optical";            ///< of the camera's frame, of such points
  std::optional<std::string> camera_file;  ///< what it says of the camera stands for the frame's and the scenario's
  bool use_scenario_camera = false;        ///< also where the file has its own
  double spread = 0.010;                   ///< m
  double spread_deg = 3.0;
  std::optional<std::string> output;  ///< JSON
  bool json = false;
};

void add_perceive(CLI::App& app, Action& action);
[[nodiscard]] int run_perceive(const PerceiveOptions& options);

}  // namespace snug::app
