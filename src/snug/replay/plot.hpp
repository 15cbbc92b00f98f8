// Plot: quantities of recordings over time, as a figure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/replay/replay.hpp"
#include "snug/report/figure.hpp"

namespace snug::replay {

/// One recording that is to be plotted.
struct PlotSource {
  std::string name;  ///< shown in the legend when there are several
  record::RecordingReader* reader = nullptr;
  std::string urdf = {};  ///< text of the robot's, for "limits"
};

/// What can be plotted, in words: "wrench", "flange", "tool", "error", "speed", "cup", "deformation", "vacuum",
/// "contacts", "solver", "joints", "limits"; and "pose:NAME" for a body.
[[nodiscard]] const std::vector<std::string>& plot_words();

/// One figure of all the quantities in `what`, one below the other. Curves of a second source are dashed. Throws
/// InputError for a word or a body that does not exist, naming the nearest, and for a selection without frames.
[[nodiscard]] report::Figure make_plot(std::span<const PlotSource> sources, const std::vector<std::string>& what,
                                       const Selection& selection);

}  // namespace snug::replay
