// Figure: curves over a common axis, drawn as SVG for papers: no browser, no scripts, fonts that everybody has.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace snug::report {

/// One line. It breaks where y is not finite.
struct Curve {
  std::string label;         ///< empty: not in the legend
  std::vector<double> x, y;  ///< as long as each other; x growing
  int color = 0;             ///< place in a palette of seven that colour-blind people can tell apart
  bool is_dashed = false;
};

/// One pair of axes.
struct Panel {
  std::string y_label;  ///< with unit: "force [N]"
  std::vector<Curve> curves;
  std::vector<std::pair<double, double>> bands;  ///< shaded spans of x
  std::string band_label;
};

struct Figure {
  std::string description;  ///< what it was made from; not drawn, but kept in the file
  std::string x_label;      ///< with unit
  std::vector<Panel> panels;
  double width_mm = 180.0;        ///< two columns of a paper
  double panel_height_mm = 45.0;  ///< of one pair of axes
  std::size_t columns = 1;        ///< of panels, filled from top to bottom; >= 1
};

/// The figure as an SVG document of version 1.1. Long curves are thinned to what can be seen: extremes are kept.
[[nodiscard]] std::string draw_svg(const Figure& figure);

/// Round numbers within [low, high], about `count` of them; `low < high`.
[[nodiscard]] std::vector<double> choose_ticks(double low, double high, int count);

}  // namespace snug::report
