// camera: a frame of a depth camera at an instant of a recording, or of a cell that is served now, with its errors and
// its truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct CameraOptions {
  std::string recording;                ///< with `click`: a scenario
  std::string output;                   ///< .png, .ply or .h5
  std::optional<std::string> scenario;  ///< instead of the recording's own
  std::optional<std::string> camera;    ///< name; absent: the scenario's first
  std::optional<double> time;           ///< s; absent: the end
  std::optional<std::string> click;     ///< address of a served cell
  std::optional<std::string> sequence;  ///< of a served cell; absent: the first
  ScenarioChanges changes;              ///< with which it is served
  ClientWords client;
  bool without_robot = false;
  std::optional<std::uint64_t> seed;  ///< of the camera's own errors; absent: the recording's
  std::uint64_t shot = 1;
  int threads = 1;
  bool exact = false;  ///< without errors
  bool json = false;
};

}  // namespace snug::app
