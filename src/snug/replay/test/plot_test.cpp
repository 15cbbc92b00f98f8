// Tests of plots: what is drawn is what was recorded, and the drawing is sound.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/plot.hpp"
#include "snug/replay/test/scratch.hpp"

namespace snug::replay {
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

int count(const std::string& text, const std::string& word) {
  int found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

/// Opens and closes match, and no attribute or text holds a bare number that is none.
void expect_sound(const std::string& svg) {
  EXPECT_TRUE(svg.starts_with("<?xml"));
  EXPECT_EQ(count(svg, "<text"), count(svg, "</text>"));
  EXPECT_EQ(count(svg, "<g "), count(svg, "</g>"));
  EXPECT_EQ(count(svg, "nan"), 0);
  EXPECT_EQ(count(svg, "inf"), 0);
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

class Plot : public ::testing::Test {
 protected:
  Plot() {
    Rng rng = Rng(2).split("plot");
    recording_ = test::random_robot_recording(rng, 50);
    record::save_recording(folder_ / "run.h5", recording_);
    reader_ = std::make_unique<record::RecordingReader>(folder_ / "run.h5");
    sources_ = {{"run.h5", reader_.get()}};
  }

  test::ScratchFolder folder_;
  record::Recording recording_;
  std::unique_ptr<record::RecordingReader> reader_;
  std::vector<PlotSource> sources_;
};

TEST_F(Plot, TakesNumbersFromTheRecording) {
  const Figure figure = make_plot(sources_, {"wrench", "pose:BOX002", "vacuum"}, {});
  ASSERT_EQ(figure.panels.size(), 6u);
  for (std::size_t i = 0; i < recording_.frames.size(); ++i) {
    const record::Frame& frame = recording_.frames[i];
    EXPECT_EQ(figure.panels[0].curves[0].x[i], frame.time);
    EXPECT_EQ(figure.panels[0].curves[2].y[i], frame.cup.F_PSo_S.force.z());
    EXPECT_EQ(figure.panels[1].curves[1].y[i], frame.cup.F_PSo_S.torque.y());
    EXPECT_EQ(figure.panels[4].curves[0].y[i], 1e-3 * frame.cup.pressure_gauge);
    if (frame.bodies[3].present) {
      EXPECT_EQ(figure.panels[2].curves[0].y[i], frame.bodies[3].X_WB.p.x());
    } else {
      EXPECT_TRUE(std::isnan(figure.panels[2].curves[0].y[i]));
    }
  }
}

TEST_F(Plot, DrawsTheLipOnlyWhileSomethingIsHeldAndJointsOnlyOfARobot) {
  const Figure figure = make_plot(sources_, {"deformation", "joints"}, {});
  ASSERT_EQ(figure.panels.size(), 6u);
  for (std::size_t i = 0; i < recording_.frames.size(); ++i) {
    const record::Frame& frame = recording_.frames[i];
    const double z = figure.panels[0].curves[0].y[i], turn = figure.panels[2].curves[0].y[i];
    EXPECT_EQ(figure.panels[4].curves[1].y[i], frame.joints[1].velocity);
    if (frame.cup.attached_body < 0) {
      EXPECT_TRUE(std::isnan(z) && std::isnan(turn));
      continue;
    }
    EXPECT_EQ(z, 1e3 * frame.cup.X_ES.p.z());
    EXPECT_EQ(figure.panels[1].curves[1].y[i], 1e3 * frame.cup.X_ES.p.y());
    const Eigen::AngleAxisd angle_axis(frame.cup.X_ES.quat);
    EXPECT_NEAR(turn, 180.0 / M_PI * angle_axis.angle() * angle_axis.axis().x(), 1e-9);  // rounding of degrees
  }
  Rng rng = Rng(2).split("plot");
  record::save_recording(folder_ / "none.h5", test::random_recording(rng, 3));
  record::RecordingReader none(folder_ / "none.h5");
  const PlotSource source = {"none.h5", &none};
  EXPECT_THROW((void)make_plot({&source, 1}, {"joints"}, {}), InputError);
}

TEST_F(Plot, DrawsEachQuantityWithAUnitOnEachAxis) {
  std::vector<std::string> words = plot_words();
  words.emplace_back("pose:BOX001");
  std::erase(words, "limits");  // this robot is made up: below
  for (const std::string& word : words) {
    SCOPED_TRACE(word);
    const Figure figure = make_plot(sources_, {word}, {});
    EXPECT_EQ(figure.x_label, "time [s]");
    ASSERT_FALSE(figure.panels.empty());
    for (const Panel& panel : figure.panels) EXPECT_TRUE(std::regex_search(panel.y_label, std::regex("\\[.+\\]$")));
    expect_sound(draw_svg(figure));
  }
}

TEST_F(Plot, TellsHowMuchOfTheLimitsOfTheRobotWasUsed) {
  EXPECT_THROW((void)make_plot(sources_, {"limits"}, {}), InputError);  // nobody knows them
  const std::string scenarios = std::string(SNUG_SOURCE_DIR) + "/scenarios/";
  recording_.header.scenario_text = read_file(scenarios + "box-demonstrator.yaml", "a scenario");
  recording_.header.joints = {"wrist_1_joint", "elbow_joint"};
  for (record::Frame& frame : recording_.frames) frame.joints.resize(2);
  record::save_recording(folder_ / "ur10.h5", recording_);
  record::RecordingReader reader(folder_ / "ur10.h5");
  const PlotSource source = {"ur10.h5", &reader, read_file(scenarios + "robots/ur10.urdf", "a URDF")};
  const Figure figure = make_plot({&source, 1}, {"limits"}, {});
  ASSERT_EQ(figure.panels.size(), 3u);
  for (std::size_t i = 0; i < recording_.frames.size(); ++i) {
    const record::JointSample& elbow = recording_.frames[i].joints[1];
    EXPECT_NEAR(figure.panels[1].curves[1].y[i], 100.0 * std::abs(elbow.velocity) / (0.5 * M_PI), 1e-9);
    EXPECT_NEAR(figure.panels[2].curves[1].y[i], 100.0 * std::abs(elbow.torque) / 150.0, 1e-9);
  }
  expect_sound(draw_svg(figure));
}

TEST_F(Plot, DashesTheSecondRecordingAndNamesBoth) {
  sources_.push_back({"other.h5", reader_.get()});
  const Figure figure = make_plot(sources_, {"speed"}, {});
  ASSERT_EQ(figure.panels[0].curves.size(), 2u);
  EXPECT_FALSE(figure.panels[0].curves[0].is_dashed);
  EXPECT_TRUE(figure.panels[0].curves[1].is_dashed);
  EXPECT_EQ(figure.panels[0].curves[1].label, "tool, other.h5");
}

TEST_F(Plot, NamesTheNearestWordOrBodyForAMistake) {
  const auto complaint = [&](const std::string& word) -> std::string {
    try {
      (void)make_plot(sources_, {word}, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint("wrenhc").find("did you mean wrench?"), std::string::npos);
  EXPECT_NE(complaint("pose:BOX01").find("did you mean BOX001?"), std::string::npos);
  EXPECT_NE(complaint("pose:").find("BOX002"), std::string::npos);
  EXPECT_NE(complaint(""), "");
}

}  // namespace
}  // namespace snug::replay
