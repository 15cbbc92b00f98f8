// Chart: groups of values below each other over one axis, as a drawing within a page.
#include "snug/report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/core/text.hpp"
#include "snug/report/figure.hpp"
#include "snug/report/internal/raw.hpp"
#include "snug/report/internal/svg.hpp"

namespace snug::report {
namespace {

constexpr double kLabel = 150.0, kPlot = 300.0, kMean = 104.0;  // widths of its three columns, px
constexpr double kLine = 22.0, kFirst = 14.0, kAxis = 22.0;     // heights: of a line, above the first, of the axis
constexpr std::size_t kLongestLabel = 24;                       // letters that fit into the first column

struct Axis {
  double low = 0.0, high = 1.0;
  int decimals = 0;  ///< of a tick

  [[nodiscard]] double x(double value) const {
    return kLabel + kPlot * std::clamp((value - low) / (high - low), 0.0, 1.0);
  }
};

void widen(std::optional<std::pair<double, double>>& range, double value) {
  if (!std::isfinite(value)) return;
  if (!range) range = {value, value};
  range = {std::min(range->first, value), std::max(range->second, value)};
}

/// What is drawn, with a margin; does not go below zero where nothing does.
Axis axis_of(const Chart& chart) {
  std::optional<std::pair<double, double>> range;
  if (chart.range) {
    widen(range, chart.range->first);
    widen(range, chart.range->second);
  } else {
    for (const ChartLine& line : chart.lines) {
      for (const Dot& dot : line.dots) widen(range, dot.value);
      if (line.interval) widen(range, line.interval->first);
      if (line.interval) widen(range, line.interval->second);
    }
  }
  if (!range) return {};
  const auto [low, high] = *range;
  const double margin = std::max(0.05 * (high - low), 1e-3 * std::max(std::abs(low), std::abs(high)) + 1e-6);
  return {low >= 0.0 ? std::max(0.0, low - margin) : low - margin, high + margin, 0};
}

std::string draw_axis(const Axis& axis, const std::vector<double>& ticks, double bottom) {
  std::string svg;
  for (const double tick : ticks) {
    svg += internal::svg_line(axis.x(tick), 2.0, axis.x(tick), bottom, "class=\"rule\"");
    svg += internal::svg_text(axis.x(tick), bottom + 14.0, fmt::format("{:.{}f}", tick + 0.0, axis.decimals), "middle");
  }
  return svg;
}

std::string draw_mean(const Axis& axis, const ChartLine& line, double y) {
  double sum = 0.0;
  int count = 0;
  for (const Dot& dot : line.dots) {
    if (!std::isfinite(dot.value)) continue;
    sum += dot.value;
    ++count;
  }
  if (count == 0) return {};
  const double mean = sum / count;
  return internal::svg_line(axis.x(mean), y - 9.0, axis.x(mean), y + 9.0, "class=\"mean\"") +
         internal::svg_text(kLabel + kPlot + 8.0, y + 4.0, fmt::format("mean {:.{}f}", mean, axis.decimals + 1),
                            "start");
}

std::string draw_line(const Axis& axis, const ChartLine& line, bool shows_mean, double y) {
  std::string svg = internal::svg_text(kLabel - 8.0, y + 4.0, printable(line.label, kLongestLabel), "end");
  svg += internal::svg_line(kLabel, y, kLabel + kPlot, y, "class=\"rule\"");
  if (line.interval && std::isfinite(line.interval->first) && std::isfinite(line.interval->second)) {
    svg += internal::svg_line(axis.x(line.interval->first), y, axis.x(line.interval->second), y, "class=\"interval\"");
  }
  for (const Dot& dot : line.dots) {
    if (!std::isfinite(dot.value)) continue;
    const std::string about = dot.about.empty() ? line.label : dot.about;
    svg += internal::svg_dot(axis.x(dot.value), y, 4.0, "class=\"dot\"", fmt::format("{}: {:.4g}", about, dot.value));
  }
  return shows_mean ? svg + draw_mean(axis, line, y) : svg;
}

}  // namespace

Markup as_markup(const Chart& chart) {
  Axis axis = axis_of(chart);
  const std::vector<double> ticks = choose_ticks(axis.low, axis.high, 5);
  if (ticks.size() > 1) {
    axis.decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(ticks[1] - ticks[0]) - 1e-9)));
  }
  const double bottom = kFirst - 0.5 * kLine + kLine * static_cast<double>(chart.lines.size()) + 4.0;
  std::string svg = draw_axis(axis, ticks, bottom);
  double y = kFirst;
  for (const ChartLine& line : chart.lines) {
    svg += draw_line(axis, line, chart.shows_means, y);
    y += kLine;
  }
  const double width = kLabel + kPlot + (chart.shows_means ? kMean : 16.0);
  return figure(chart.title, internal::Raw::of(internal::svg_drawing(width, bottom + kAxis, chart.title, svg)));
}

}  // namespace snug::report
