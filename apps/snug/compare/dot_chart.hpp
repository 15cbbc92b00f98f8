// A chart of dots: one line for each group of values, all on one axis, as SVG within a page.
#pragma once

#include <string>
#include <vector>

namespace snug::app {

/// One value; NaN where there is none.
struct Dot {
  double value = 0.0;
  std::string about;  ///< what it is of: shown under the mouse, before the value
};

struct DotLine {
  std::string label;
  std::vector<Dot> dots;
};

/// A figure with a dot for each value, a bar at the mean of each line, and round numbers on the axis. Values are not
/// negative.
[[nodiscard]] std::string draw_dot_chart(const std::string& title, const std::vector<DotLine>& lines);

/// What the figures need in the page's style sheet.
extern const char* const kDotChartStyle;

}  // namespace snug::app
