// picture: one instant of a recording as PNG, or many for a video, drawn without a screen.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct PictureOptions {
  std::string recording;
  std::string output;              ///< one picture; empty: a video
  std::optional<double> time;      ///< s; absent: the end
  std::string video;               ///< folder for numbered pictures; empty: one picture
  double fps = 25.0;               ///< pictures a second
  double speed = 1.0;              ///< of the video: recorded seconds a second
  std::optional<double> from, to;  ///< s; of the video
  int width = 1280, height = 800;
  std::string camera = "cell";
  std::string theme = "light";
  std::optional<std::string> urdf;  ///< of the robot in it; absent: looked for
  std::string show, hide;           ///< parts of the drawing, separated by commas
};

void add_picture(CLI::App& app, Action& action);
[[nodiscard]] int run_picture(const PictureOptions& options);

}  // namespace snug::app
