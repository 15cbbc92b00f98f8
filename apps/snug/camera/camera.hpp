// camera: a frame of a depth camera at an instant of a recording, with its errors and its truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct CameraOptions {
  std::string recording;
  std::string output;                   ///< .png, .ply or .h5
  std::optional<std::string> scenario;  ///< instead of the recording's own
  std::optional<std::string> camera;    ///< name; absent: the scenario's first
  std::optional<double> time;           ///< s; absent: the end
  std::optional<std::uint64_t> seed;    ///< of the camera's own errors; absent: the recording's
  std::uint64_t shot = 1;
  int threads = 1;
  bool exact = false;  ///< without errors
  bool json = false;
};

void add_camera(CLI::App& app, Action& action);
[[nodiscard]] int run_camera(const CameraOptions& options);

}  // namespace snug::app
