// Tests of figures: the drawing is sound whatever the numbers are, and shows what they are.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>
#include <set>

#include "snug/core/rng.hpp"
#include "snug/report/figure.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::report {
namespace {

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  Rng rng = Rng(1).split("ticks");
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const double span = std::pow(10.0, rng.uniform(-9.0, 9.0));
    const double low = rng.uniform(-3.0, 3.0) * span;
    const std::vector<double> ticks = choose_ticks(low, low + span, 5);
    ASSERT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 9u);
    EXPECT_GE(ticks.front(), low - 1e-6 * span);
    EXPECT_LE(ticks.back(), low + span + 1e-6 * span);
    const double step = ticks[1] - ticks[0];
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    EXPECT_NEAR(std::min({std::abs(mantissa - 1.0), std::abs(mantissa - 2.0), std::abs(mantissa - 5.0)}), 0.0, 1e-6);
  }
}

Panel panel_with(std::vector<double> x, std::vector<double> y) {
  return {"force [N]", {{"F<x>", std::move(x), std::move(y), 0, false}}, {}, ""};
}

TEST(Figure, DrawsNothingStrangeForStrangeNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::vector<double>, std::vector<double>>> cases = {
      {{}, {}},
      {{1.0}, {2.0}},
      {{0, 1, 2}, {nan, nan, nan}},
      {{0, 1, 2}, {5.0, 5.0, 5.0}},
      {{0, 1, 2}, {0.0, 0.0, 0.0}},
      {{0, 1, 2}, {1e300, -1e300, 0.0}},
      {{0, 1, 2}, {1.0, infinity, -infinity}},
      {{0, 1, 2}, {1e-300, 2e-300, 0.0}},
      {{1e6, 1e6 + 1e-9}, {1.0, 2.0}}};
  for (const auto& [x, y] : cases) {
    Figure figure;
    figure.description = "a & b < c";
    figure.x_label = "time [s]";
    figure.panels = {panel_with(x, y), panel_with(x, y)};
    const std::string svg = draw_svg(figure);
    expect_sound(svg);
    EXPECT_NE(svg.find("F&lt;x&gt;"), std::string::npos);
    EXPECT_NE(svg.find("a &amp; b &lt; c"), std::string::npos);
    EXPECT_LT(svg.size(), 50'000u);
  }
}

TEST(Figure, FillsColumnsFromTopToBottomEachWithItsAxis) {
  Figure figure;
  figure.x_label = "time [s]";
  for (int i = 0; i < 5; ++i) figure.panels.push_back(panel_with({0, 1, 2}, {1.0, 2.0, 0.0}));
  const std::string one = draw_svg(figure);
  figure.columns = 2;
  const std::string two = draw_svg(figure);
  expect_sound(two);
  EXPECT_EQ(count(one, ">time [s]<"), 1);
  EXPECT_EQ(count(two, ">time [s]<"), 2);
  const auto height_of = [](const std::string& svg) { return std::stod(svg.substr(svg.find("height=\"") + 8)); };
  EXPECT_LT(height_of(two), 0.7 * height_of(one));  // three rows instead of five
  EXPECT_EQ(count(two, "clip-path=\"url(#axes"), 5);
}

TEST(Figure, BreaksACurveWhereThereIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Figure figure;
  figure.panels = {panel_with({0, 1, 2, 3, 4}, {1, 2, nan, 4, 5})};
  const std::string svg = draw_svg(figure);
  const std::size_t path = svg.find("<path d=\"");
  EXPECT_EQ(count(svg.substr(path, svg.find("/>", path) - path), "M"), 2);
}

TEST(Figure, WritesLongLegendsInSeveralLinesWithinTheDrawing) {
  Figure figure;
  figure.x_label = "time [s]";
  figure.width_mm = 85.0;
  Panel panel = panel_with({0, 1}, {1, 2});
  for (int i = 0; i < 12; ++i) panel.curves.push_back({"a_rather_long_joint, run.h5", {0, 1}, {1, 2}, i, false});
  figure.panels = {panel, panel_with({0, 1}, {1, 2})};
  const std::string svg = draw_svg(figure);
  expect_sound(svg);
  const std::regex text("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"start\">([^<]*)");
  std::set<std::string> lines;
  for (std::sregex_iterator at(svg.begin(), svg.end(), text), end; at != end; ++at) {
    lines.insert((*at)[2]);
    const std::string label = (*at)[3];
    if (label.front() != 'a') continue;
    EXPECT_LT(std::stod((*at)[1]) + 4.24 * static_cast<double>(label.size()), 85.0 * 72.0 / 25.4);  // 0.53 of 8 pt each
    EXPECT_GT(std::stod((*at)[2]), 0.0);
  }
  EXPECT_GE(lines.size(), 7u);
}

TEST(Figure, KeepsTheExtremesOfACurveThatItThins) {
  std::vector<double> x, y;
  for (int i = 0; i < 100'000; ++i) {
    x.push_back(0.008 * i);
    y.push_back(std::sin(0.001 * i));
  }
  y[34'567] = 9.0;  // one sample each, easily lost
  y[76'543] = -7.0;
  Figure figure;
  figure.panels = {panel_with(x, y)};
  const std::string svg = draw_svg(figure);
  EXPECT_LT(svg.size(), 100'000u);
  const std::size_t path = svg.find("<path d=\"");
  const std::string data = svg.substr(path, svg.find("/>", path) - path);
  double lowest = 1e9, highest = -1e9;
  const std::regex point("[ML]([0-9.]+) ([0-9.]+)");
  for (std::sregex_iterator at(data.begin(), data.end(), point), end; at != end; ++at) {
    lowest = std::min(lowest, std::stod((*at)[2]));
    highest = std::max(highest, std::stod((*at)[2]));
  }
  // Axes are 45 mm high, 17 pt below the top; the range is 16 with 6 % left free at either end. Two decimals.
  const double height = 45.0 * 72.0 / 25.4;
  EXPECT_NEAR(lowest, 17.0 + 0.06 / 1.12 * height, 0.01);
  EXPECT_NEAR(highest, 17.0 + 1.06 / 1.12 * height, 0.01);
}

}  // namespace
}  // namespace snug::report
