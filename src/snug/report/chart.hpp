// Chart: groups of values below each other over one axis, as a drawing within a page: a dot for each value, a bar at
// the mean, or a mean with its interval.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snug/report/markup.hpp"

namespace snug::report {

/// One value; not finite: none.
struct Dot {
  double value = 0.0;
  std::string about;  ///< what it is of: shown under the mouse, before the value
};

struct ChartLine {
  std::string label;
  std::vector<Dot> dots;
  std::optional<std::pair<double, double>> interval;  ///< low and high, drawn through the dots
};

struct Chart {
  std::string title;
  std::vector<ChartLine> lines;
  bool shows_means = true;                         ///< a bar at the mean of each line, and its number
  std::optional<std::pair<double, double>> range;  ///< of the axis; absent: what is drawn
};

/// Values are shown with four digits. A chart without values has an axis from 0 to 1.
[[nodiscard]] Markup as_markup(const Chart& chart);

}  // namespace snug::report
