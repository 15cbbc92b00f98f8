// Charts and plans: dots stand where their values say, whatever the values are.
#include "snug/report/chart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <regex>

#include "snug/core/rng.hpp"
#include "snug/report/floor_plan.hpp"
#include "snug/report/plan_view.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Places of all circles, along x.
std::vector<double> dots_of(const std::string& svg) {
  std::vector<double> xs;
  const std::regex circle("<circle cx=\"([-0-9.]+)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), circle), end; at != end; ++at) xs.push_back(std::stod((*at)[1]));
  return xs;
}

TEST(Chart, DotsStandInProportionToTheirValues) {
  Rng rng = Rng(3).split("chart");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const double scale = std::pow(10.0, rng.uniform(-3.0, 6.0)), low = rng.uniform(-1.0, 1.0) * scale;
    const double third = rng.uniform(0.05, 0.95);
    const Chart chart{"t", {{"a", {{low, ""}, {low + scale, ""}, {low + third * scale, ""}}, {}}}, true, {}};
    const std::vector<double> xs = dots_of(as_markup(chart).html());
    ASSERT_EQ(xs.size(), 3u);
    EXPECT_NEAR((xs[2] - xs[0]) / (xs[1] - xs[0]), third, 1e-4);  // two decimals of some 270
  }
}

TEST(Chart, TheMeanIsTheMeanAndMissingValuesAreNotInIt) {
  const Chart chart{"t", {{"a", {{10.0, ""}, {20.0, ""}, {kNone, ""}}, {}}, {"b", {{kNone, ""}}, {}}}, true, {}};
  const std::string svg = as_markup(chart).html();
  EXPECT_EQ(count(svg, "class=\"mean\""), 1);
  EXPECT_NE(svg.find(">mean 15.0<"), std::string::npos);
  EXPECT_EQ(dots_of(svg).size(), 2u);
}

TEST(Chart, IsSoundForStrangeValuesAndNames) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& values : std::vector<std::vector<double>>{{},
                                                                            {0.0},
                                                                            {5.0, 5.0},
                                                                            {kNone},
                                                                            {infinity, -infinity, 1.0},
                                                                            {1e300, 1e-300},
                                                                            {-3.0, 4.0},
                                                                            {1e15, 1e15 + 1.0}}) {
    Chart chart{"<title>", {{"</svg>&\u202e a very long label that does not fit anywhere", {}, {}}}, true, {}};
    for (const double value : values) chart.lines[0].dots.push_back({value, "'\"<"});
    const std::string svg = as_markup(chart).html();
    expect_well_formed(svg);
    EXPECT_FALSE(std::regex_search(svg, std::regex("=\"-?(nan|inf)")));
    for (const double x : dots_of(svg)) EXPECT_TRUE(x >= 150.0 && x <= 450.0) << x;
    EXPECT_LT(svg.size(), 30'000u);
  }
}

TEST(Chart, IntervalsAndACommonRangeAreKept) {
  Chart chart{"t", {{"a", {{2.0, ""}}, std::pair(1.0, 3.0)}}, false, std::pair(0.0, 10.0)};
  const std::string svg = as_markup(chart).html();
  const std::regex line("<line x1=\"([0-9.]+)\" y1=\"[0-9.]+\" x2=\"([0-9.]+)\" y2=\"[0-9.]+\" class=\"interval\"");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(svg, found, line));
  const double x = dots_of(svg).at(0);
  EXPECT_NEAR(std::stod(found[1]) + std::stod(found[2]), 2.0 * x, 0.02);
  EXPECT_NEAR(std::stod(found[2]) - std::stod(found[1]), 2.0 * 300.0 / (10.0 + 2.0 * 0.5 - 0.5), 0.02)
      << "the axis goes from 0 to 10.5: a margin of 5 %, not below zero";
  EXPECT_EQ(count(svg, "mean"), 0);
}

TEST(PlanView, ATurnedBoxHasFourCornersWhereTrigonometryPutsThem) {
  const double angle = std::numbers::pi / 6.0;
  const Pose X_TP{Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix(), Vector3(0.1, -0.05, 0.04)};
  const BoxOutline outline = outline_of("B", Vector3(0.2, 0.1, 0.08), X_TP);
  ASSERT_EQ(outline.corners_T.size(), 4u);
  EXPECT_NEAR(outline.top, 0.08, 1e-12);
  double widest = -1.0;
  for (const Eigen::Vector2d& p : outline.corners_T) widest = std::max(widest, p.x());
  EXPECT_NEAR(widest, 0.1 + 0.1 * std::cos(angle) + 0.05 * std::sin(angle), 1e-12);
}

TEST(PlanView, ATiltedBoxIsTheHullOfItsCorners) {
  Rng rng = Rng(4).split("plan");
  for (int i = 0; i < 200; ++i) {
    const Quaternion q(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    const BoxOutline outline =
        outline_of("B", Vector3(0.3, 0.2, 0.1), {q.normalized().toRotationMatrix(), Vector3::Zero()});
    EXPECT_GE(outline.corners_T.size(), 4u);
    EXPECT_LE(outline.corners_T.size(), 6u) << "a box seen along any direction has at most six corners";
  }
}

TEST(PlanView, HigherBoxesAreDrawnLaterAndNamesAreEscaped) {
  const Markup view =
      plan_view({0.4, 0.3, 0.2}, {outline_of("<high>", {0.1, 0.1, 0.1}, {Matrix3::Identity(), {0, 0, 0.15}}),
                                  outline_of("low", {0.1, 0.1, 0.1}, {Matrix3::Identity(), {0, 0, 0.05}})});
  expect_well_formed(view.html());
  EXPECT_EQ(count(view.html(), "<polygon"), 2);
  EXPECT_LT(view.html().find("low, top at 100 mm"), view.html().find("&lt;high&gt;, top at 200 mm"));
}

TEST(Chart, FloorPlanIsToScaleAndEscapesNames) {
  FloorPlan plan;
  plan.about = "a cell";
  plan.outlines.push_back({"<bench>", {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}}, PlanInk::Ground, true});
  plan.circles.push_back({{1.0, 0.5}, 0.25, "reach"});
  plan.dots = {{{0.5, 0.5}, PlanInk::Reached, "a"}, {{1.5, 0.5}, PlanInk::Unreached, "b"}};
  const std::string html = floor_plan(plan).html();
  expect_well_formed(html);
  EXPECT_NE(html.find("&lt;bench&gt;"), std::string::npos);
  const std::vector<double> xs = dots_of(html);
  ASSERT_EQ(xs.size(), 3U);
  // The circle stands between the dots, which are as far apart as four radii.
  EXPECT_NEAR(xs[0], 0.5 * (xs[1] + xs[2]), 0.02);
  const std::size_t radius = html.find(" r=\"");
  EXPECT_NEAR(xs[2] - xs[1], 4.0 * std::stod(html.substr(radius + 4)), 0.1);
  expect_well_formed(floor_plan({}).html());
}

}  // namespace
}  // namespace snug::report
