// Figure: curves over a common axis, drawn as SVG for papers: no browser, no scripts, fonts that everybody has.
#include "snug/report/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string_view>

#include "snug/report/escape.hpp"
#include "snug/report/internal/svg.hpp"

namespace snug::report {
namespace {

using internal::svg_line;
using internal::svg_rect;
using internal::svg_text;

// Okabe and Ito's palette without its yellow, which is too light for a line on white.
constexpr std::array<std::string_view, 7> kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                     "#000000", "#56B4E9", "#E69F00"};
constexpr double kPointsPerMm = 72.0 / 25.4;  // the drawing's unit is the typographic point
constexpr double kFont = 8.0;
constexpr double kLeft = 46.0, kRight = 12.0, kBottom = 34.0;
constexpr double kLegend = 17.0;        // height of the line of labels above a pair of axes
constexpr double kLegendLine = 10.0;    // of each further one
constexpr double kGapOfPanels = 9.0;    // between pairs of axes
constexpr double kColumnsPerPoint = 2;  // of a curve, beyond which points are thinned

struct Range {
  double low = 0.0, high = 1.0;
};

/// From data to drawing.
struct Axes {
  Range x, y;
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;

  [[nodiscard]] double across(double value) const { return left + (value - x.low) / (x.high - x.low) * width; }
  [[nodiscard]] double down(double value) const { return top + (y.high - value) / (y.high - y.low) * height; }
};

void widen(Range& range, double value) {
  if (!std::isfinite(value)) return;
  range.low = std::min(range.low, value);
  range.high = std::max(range.high, value);
}

Range closed(Range range, double margin) {
  if (range.low > range.high) return {0.0, 1.0};
  const double size = std::max({std::abs(range.low), std::abs(range.high), 1e-12});
  const double span = range.high - range.low;
  const double extra = span > 1e-9 * size ? margin * span : 0.5 * size;
  return {range.low - extra, range.high + extra};
}

constexpr Range kEmpty = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

Range x_range(const Figure& figure) {
  Range range = kEmpty;
  for (const Panel& panel : figure.panels) {
    for (const Curve& curve : panel.curves) {
      if (curve.x.empty()) continue;
      widen(range, curve.x.front());
      widen(range, curve.x.back());
    }
  }
  if (range.low > 0.0 && range.low < 0.01 * range.high) range.low = 0.0;  // the first frame is one period after 0
  return closed(range, 0.0);
}

Range y_range(const Panel& panel) {
  Range range = kEmpty;
  for (const Curve& curve : panel.curves) {
    for (const double value : curve.y) widen(range, value);
  }
  return closed(range, 0.06);
}

/// "-0.25" with a proper minus sign and as many decimals as the step between ticks needs.
std::string tick_text(double value, double step) {
  const double size = std::max(std::abs(value), step);
  if (size >= 1e5 || size < 1e-4) {
    std::string text = value == 0.0 ? "0" : fmt::format("{:.3g}", value);
    if (text.front() == '-') text.replace(0, 1, "\u2212");
    return text;
  }
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
  return (value < -0.5 * step * 1e-6 ? "\u2212" : "") + text;
}

double step_of(const std::vector<double>& ticks) { return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0; }

/// First, lowest, highest and last point of each narrow column: looks like the whole curve.
std::vector<std::size_t> thinned(const Curve& curve, std::size_t begin, std::size_t end, const Axes& axes) {
  const auto columns = static_cast<std::size_t>(axes.width * kColumnsPerPoint);
  std::vector<std::size_t> kept;
  if (end - begin <= 4 * columns) {
    for (std::size_t i = begin; i < end; ++i) kept.push_back(i);
    return kept;
  }
  const auto column_of = [&](std::size_t i) {
    return static_cast<long>(kColumnsPerPoint * (axes.across(curve.x[i]) - axes.left));
  };
  for (std::size_t i = begin; i < end;) {
    const std::size_t first = i;
    std::size_t low = i, high = i;
    for (; i < end && column_of(i) == column_of(first); ++i) {
      if (curve.y[i] < curve.y[low]) low = i;
      if (curve.y[i] > curve.y[high]) high = i;
    }
    std::array<std::size_t, 4> points = {first, low, high, i - 1};
    std::sort(points.begin(), points.end());
    std::unique_copy(points.begin(), points.end(), std::back_inserter(kept));
  }
  return kept;
}

std::string style_of(const Curve& curve) {
  return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1\"{} stroke-linejoin=\"round\"",
                     kColors[static_cast<std::size_t>(curve.color) % kColors.size()],
                     curve.is_dashed ? " stroke-dasharray=\"3.5 2\"" : "");
}

std::string draw_curve(const Curve& curve, const Axes& axes) {
  std::string path;
  const std::size_t size = std::min(curve.x.size(), curve.y.size());
  const auto is_drawn = [&](std::size_t i) { return std::isfinite(curve.x[i]) && std::isfinite(curve.y[i]); };
  for (std::size_t begin = 0; begin < size;) {
    while (begin < size && !is_drawn(begin)) ++begin;
    std::size_t end = begin;
    while (end < size && is_drawn(end)) ++end;
    char command = 'M';
    for (const std::size_t i : thinned(curve, begin, end, axes)) {
      path += fmt::format("{}{:.2f} {:.2f}", command, axes.across(curve.x[i]), axes.down(curve.y[i]));
      command = 'L';
    }
    begin = end;
  }
  if (path.empty()) return "";
  return fmt::format("<path d=\"{}\" {}/>\n", path, style_of(curve));
}

/// Width of a text in the fonts asked for, near enough to lay out labels: Helvetica's average.
double width_of(std::string_view text) {
  const auto letters =
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return 0.53 * kFont * static_cast<double>(letters);
}

constexpr double kSwatch = 16.0, kSpace = 4.0, kBetween = 11.0;

/// A label with its line or band before it, and where it is in the legend.
struct LegendEntry {
  std::string_view label;
  const Curve* curve;  ///< nullptr: the band
  double x = 0.0;      ///< from the beginning of its line
  int line = 0;
};

struct Legend {
  std::vector<LegendEntry> entries;
  std::vector<double> widths;  ///< of each line
  [[nodiscard]] double height() const { return kLegend + kLegendLine * (static_cast<double>(widths.size()) - 1.0); }
};

Legend lay_out_legend(const Panel& panel, double width) {
  Legend legend;
  if (!panel.band_label.empty() && !panel.bands.empty()) legend.entries.push_back({panel.band_label, nullptr});
  for (const Curve& curve : panel.curves) {
    if (!curve.label.empty()) legend.entries.push_back({curve.label, &curve});
  }
  legend.widths = {0.0};
  for (LegendEntry& entry : legend.entries) {
    const double size = kSwatch + kSpace + width_of(entry.label) + kBetween;
    if (legend.widths.back() > 0.0 && legend.widths.back() + size - kBetween > width) legend.widths.push_back(0.0);
    entry.x = legend.widths.back();
    entry.line = static_cast<int>(legend.widths.size()) - 1;
    legend.widths.back() += size;
  }
  return legend;
}

std::string draw_legend(const Panel& panel, const Axes& axes) {
  const Legend legend = lay_out_legend(panel, axes.width);
  std::string out;
  for (const LegendEntry& entry : legend.entries) {
    const double width = legend.widths[static_cast<std::size_t>(entry.line)];
    const double x = std::max(axes.left, axes.left + axes.width - width + kBetween) + entry.x;
    const auto lines_below = static_cast<double>(legend.widths.size()) - 1.0 - entry.line;
    const double y = axes.top - 6.0 - kLegendLine * lines_below;
    if (entry.curve != nullptr) {
      out += svg_line(x, y - 2.6, x + kSwatch, y - 2.6, style_of(*entry.curve));
    } else {
      out += svg_rect(x, y - 6.0, kSwatch, 7.0, "fill=\"#E6E6E6\"");
    }
    out += svg_text(x + kSwatch + kSpace, y, entry.label, "start");
  }
  return out;
}

std::string draw_bands(const Panel& panel, const Axes& axes) {
  std::string out;
  for (const auto& [from, to] : panel.bands) {
    const double left = axes.across(std::clamp(from, axes.x.low, axes.x.high));
    const double right = axes.across(std::clamp(to, axes.x.low, axes.x.high));
    if (right - left < 0.05) continue;
    out += svg_rect(left, axes.top, right - left, axes.height, "fill=\"#E6E6E6\"");
  }
  return out;
}

std::string draw_grid(const Axes& axes, bool has_x_labels) {
  std::string out;
  const double bottom = axes.top + axes.height;
  const std::vector<double> ys = choose_ticks(axes.y.low, axes.y.high, std::max(3, static_cast<int>(axes.height / 24)));
  for (const double y : ys) {
    const bool is_zero = std::abs(y) < 1e-9 * step_of(ys);
    out += svg_line(axes.left, axes.down(y), axes.left + axes.width, axes.down(y),
                    is_zero ? "stroke=\"#999999\" stroke-width=\"0.6\"" : "stroke=\"#D9D9D9\" stroke-width=\"0.4\"");
    out += svg_text(axes.left - 4.0, axes.down(y) + 2.8, tick_text(y, step_of(ys)), "end");
  }
  const std::vector<double> xs = choose_ticks(axes.x.low, axes.x.high, std::max(3, static_cast<int>(axes.width / 48)));
  for (const double x : xs) {
    out += svg_line(axes.across(x), bottom, axes.across(x), bottom - 3.0, "stroke=\"#000000\" stroke-width=\"0.6\"");
    if (has_x_labels) out += svg_text(axes.across(x), bottom + 10.5, tick_text(x, step_of(xs)), "middle");
  }
  return out;
}

std::size_t rows_of(const Figure& figure) {
  return std::max<std::size_t>(1, (figure.panels.size() + figure.columns - 1) / figure.columns);
}

/// Height of the legends of a row of panels: that of the highest.
double legend_height(const Figure& figure, std::size_t row, double width) {
  double height = 0.0;
  for (std::size_t i = row; i < figure.panels.size(); i += rows_of(figure))
    height = std::max(height, lay_out_legend(figure.panels[i], width).height());
  return height;
}

std::string draw_panel(const Figure& figure, std::size_t index, const Axes& axes) {
  const Panel& panel = figure.panels[index];
  const bool is_last = index + 1 == figure.panels.size() || (index + 1) % rows_of(figure) == 0;
  std::string out = draw_bands(panel, axes) + draw_grid(axes, is_last);
  out += fmt::format(
      "<clipPath id=\"axes{}\"><rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>"
      "</clipPath>\n<g clip-path=\"url(#axes{})\">\n",
      index, axes.left, axes.top, axes.width, axes.height, index);
  for (const Curve& curve : panel.curves) out += draw_curve(curve, axes);
  out += "</g>\n";
  out +=
      svg_rect(axes.left, axes.top, axes.width, axes.height, "fill=\"none\" stroke=\"#000000\" stroke-width=\"0.6\"");
  const double middle = axes.top + 0.5 * axes.height;
  const double label = axes.left - kLeft + 10.0;
  out += svg_text(label, middle, panel.y_label, "middle",
                  fmt::format(" transform=\"rotate(-90 {:.2f} {:.2f})\"", label, middle));
  if (is_last) {
    out += svg_text(axes.left + 0.5 * axes.width, axes.top + axes.height + 24.0, figure.x_label, "middle");
  }
  return out + draw_legend(panel, axes);
}

}  // namespace

std::vector<double> choose_ticks(double low, double high, int count) {
  const double rough = (high - low) / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power;
  for (const double nice : {2.0, 5.0, 10.0}) {  // the nearest as ratios go
    if (nice * power / rough < rough / step) step = nice * power;
  }
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    ticks.push_back(i * step);
    if (ticks.size() > 1000) break;  // steps below the precision of the numbers
  }
  return ticks;
}

std::string draw_svg(const Figure& figure) {
  const double width = figure.width_mm * kPointsPerMm;
  const double panel_height = figure.panel_height_mm * kPointsPerMm;
  const std::size_t rows = figure.panels.empty() ? 0 : rows_of(figure);
  const double column = width / static_cast<double>(figure.columns);
  Axes axes;
  axes.width = column - kLeft - kRight;
  axes.height = panel_height;
  const auto count = static_cast<double>(rows);
  double height = count * panel_height + std::max(0.0, count - 1.0) * kGapOfPanels + kBottom;
  for (std::size_t row = 0; row < rows; ++row) height += legend_height(figure, row, axes.width);
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{:.2f}mm\" height=\"{:.2f}mm\" "
      "viewBox=\"0 0 {:.2f} {:.2f}\" font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" "
      "font-size=\"{}\" fill=\"#000000\">\n<desc>{}</desc>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
      width / kPointsPerMm, height / kPointsPerMm, width, height, kFont, escape(figure.description));
  axes.x = x_range(figure);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    if (i % rows == 0) axes.top = 0.0;
    axes.left = kLeft + column * static_cast<double>(i / rows);
    axes.y = y_range(figure.panels[i]);
    axes.top += legend_height(figure, i % rows, axes.width);
    svg += draw_panel(figure, i, axes);
    axes.top += panel_height + kGapOfPanels;
  }
  return svg + "</svg>\n";
}

}  // namespace snug::report
