// Tests of plots: what is drawn is what was recorded, and the drawing is sound.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/plot.hpp"
#include "snug/replay/test/scratch.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::replay {
namespace {

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
  const report::Figure figure = make_plot(sources_, {"wrench", "pose:BOX002", "vacuum"}, {});
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
  const report::Figure figure = make_plot(sources_, {"deformation", "joints"}, {});
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
    const report::Figure figure = make_plot(sources_, {word}, {});
    EXPECT_EQ(figure.x_label, "time [s]");
    ASSERT_FALSE(figure.panels.empty());
    for (const report::Panel& panel : figure.panels)
      EXPECT_TRUE(std::regex_search(panel.y_label, std::regex("\\[.+\\]$")));
    report::expect_sound(report::draw_svg(figure));
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
  const report::Figure figure = make_plot({&source, 1}, {"limits"}, {});
  ASSERT_EQ(figure.panels.size(), 3u);
  for (std::size_t i = 0; i < recording_.frames.size(); ++i) {
    const record::JointSample& elbow = recording_.frames[i].joints[1];
    EXPECT_NEAR(figure.panels[1].curves[1].y[i], 100.0 * std::abs(elbow.velocity) / (0.97 * M_PI), 1e-9);
    EXPECT_NEAR(figure.panels[2].curves[1].y[i], 100.0 * std::abs(elbow.torque) / 150.0, 1e-9);
  }
  report::expect_sound(report::draw_svg(figure));
}

TEST_F(Plot, DashesTheSecondRecordingAndNamesBoth) {
  sources_.push_back({"other.h5", reader_.get()});
  const report::Figure figure = make_plot(sources_, {"speed"}, {});
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
