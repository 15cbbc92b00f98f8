// picture: one instant of a recording as PNG, drawn without a screen.
#pragma once

#include <optional>
#include <string>

#include "verb.hpp"

namespace snug::app {

struct PictureOptions {
  std::string recording;
  std::string output;
  std::optional<double> time;  ///< s; absent: the end
  int width = 1280, height = 800;
  std::string camera = "cell";
  std::string theme = "light";
  std::string show, hide;  ///< parts of the drawing, separated by commas
};

void add_picture(CLI::App& app, Action& action);
[[nodiscard]] int run_picture(const PictureOptions& options);

}  // namespace snug::app
