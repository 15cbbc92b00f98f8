// plot: quantities of a recording as an SVG for papers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"
#include "snug/replay/replay.hpp"

namespace snug::app {

struct PlotOptions {
  std::vector<std::string> recordings;  ///< one, or one and a second to lay over it
  std::vector<std::string> what;
  std::string output;
  double width_mm = 180.0;
  double height_mm = 45.0;          ///< of each pair of axes
  std::optional<std::string> urdf;  ///< of the robot in them, for limits; absent: looked for
  replay::Selection selection;
};

void add_plot(CLI::App& app, Action& action);
[[nodiscard]] int run_plot(const PlotOptions& options);

}  // namespace snug::app
