// A chart of dots: one line for each group of values, all on one axis, as SVG within a page.
#include "apps/snug/compare/dot_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "snug/core/text.hpp"
#include "snug/report/figure.hpp"

namespace snug::app {
namespace {

constexpr double kLabel = 170.0, kPlot = 320.0, kMean = 80.0;  // widths of its three columns, px
constexpr double kLine = 22.0, kFirst = 14.0, kAxis = 22.0;    // heights: of a line, above the first, of the axis

struct Axis {
  double low = 0.0, high = 1.0;
  int decimals = 0;  ///< of a tick

  [[nodiscard]] double x(double value) const { return kLabel + kPlot * (value - low) / (high - low); }
};

Axis make_axis(const std::vector<DotLine>& lines) {
  std::optional<std::pair<double, double>> range;
  for (const DotLine& line : lines) {
    for (const Dot& dot : line.dots) {
      if (!std::isfinite(dot.value)) continue;
      if (!range) range = {dot.value, dot.value};
      range = {std::min(range->first, dot.value), std::max(range->second, dot.value)};
    }
  }
  if (!range) return {};
  const auto [low, high] = *range;
  const double margin = std::max(0.05 * (high - low), 1e-3 * high + 1e-6);
  return {std::max(0.0, low - margin), high + margin, 0};  // nothing here is negative
}

std::string draw_axis(const Axis& axis, const std::vector<double>& ticks, double bottom) {
  std::string svg;
  for (const double tick : ticks) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"2\" y2=\"{1:.0f}\" class=\"rule\"/>"
        "<text x=\"{0:.1f}\" y=\"{2:.0f}\" text-anchor=\"middle\">{3:.{4}f}</text>",
        axis.x(tick), bottom, bottom + 14.0, tick + 0.0, axis.decimals);  // no -0
  }
  return svg;
}

std::string draw_line(const Axis& axis, const DotLine& line, double y) {
  std::string svg = fmt::format(
      "<text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text><line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" y2=\"{:.0f}\" "
      "class=\"rule\"/>",
      kLabel - 8.0, y + 4.0, escape_markup(line.label), kLabel, kLabel + kPlot, y, y);
  double sum = 0.0;
  int count = 0;
  for (const Dot& dot : line.dots) {
    if (!std::isfinite(dot.value)) continue;
    sum += dot.value;
    ++count;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.0f}\" r=\"4\"><title>{}: {:.4g}</title></circle>",
                       axis.x(dot.value), y, escape_markup(dot.about), dot.value);
  }
  if (count == 0) return svg;
  const double mean = sum / count;
  return svg + fmt::format(
                   "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.0f}\" y2=\"{2:.0f}\" class=\"mean\"/>"
                   "<text x=\"{3}\" y=\"{4:.0f}\">mean {5:.{6}f}</text>",
                   axis.x(mean), y - 9.0, y + 9.0, kLabel + kPlot + 8.0, y + 4.0, mean, axis.decimals + 1);
}

}  // namespace

const char* const kDotChartStyle =
    "figure{margin:0}figcaption{font-weight:600}svg text{font-size:11px;fill:#44505c}circle{fill:#2b6cb0;"
    "fill-opacity:.65}.rule{stroke:#e3e8ed}.mean{stroke:#c05621;stroke-width:3}";

std::string draw_dot_chart(const std::string& title, const std::vector<DotLine>& lines) {
  Axis axis = make_axis(lines);
  const std::vector<double> ticks = report::choose_ticks(axis.low, axis.high, 5);
  if (ticks.size() > 1) {
    axis.decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(ticks[1] - ticks[0]) - 1e-9)));
  }
  const double bottom = kFirst - 0.5 * kLine + kLine * static_cast<double>(lines.size()) + 4.0;
  std::string svg = fmt::format("<figure><figcaption>{}</figcaption><svg width=\"{}\" height=\"{}\" role=\"img\">",
                                escape_markup(title), kLabel + kPlot + kMean, bottom + kAxis) +
                    draw_axis(axis, ticks, bottom);
  double y = kFirst;
  for (const DotLine& line : lines) {
    svg += draw_line(axis, line, y);
    y += kLine;
  }
  return svg + "</svg></figure>";
}

}  // namespace snug::app
