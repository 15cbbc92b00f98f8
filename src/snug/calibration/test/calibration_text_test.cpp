// What was calibrated as text: numbers and units of JSON and lines, and blocks that a scenario takes.
#include "snug/calibration/calibration_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/calibration/test/nominal.hpp"
#include "snug/core/input_error.hpp"

namespace snug::calibration {
namespace {

using nlohmann::json;
using test::nominal;

TEST(CalibrationText, OfAToolSaysWhereItIsAndHowFarFromNominal) {
  const int flange = robot::find_link(nominal(), "tool0");
  const Pose X_FE = nominal().links[static_cast<std::size_t>(flange)].X_SL.inverse() * nominal().X_SE;
  ToolTip tip;
  tip.p_FQ = X_FE * Vector3(0.0, 0.0, 0.05) + Vector3(0.001, 0.0, 0.0);
  tip.covariance = Vector3(1e-8, 4e-8, 9e-8).asDiagonal();
  tip.noise = 2e-4;
  const ToolReport report = report_tool(tip, nominal(), flange, Vector3(0.0, 0.0, 0.05));
  EXPECT_NEAR((report.shift - Vector3(0.001, 0.0, 0.0)).norm(), 0.0, 1e-15) << "what the tip is beyond the cone";
  const json written = json::parse(format_json(report));
  EXPECT_NEAR(written.at("tool_shift_m").at(0).get<double>(), 0.001, 1e-15);
  EXPECT_NEAR(written.at("tip_standard_deviation_m").at(2).get<double>(), 3e-4, 1e-18);
  const std::string text = format_text(report, "tool0");
  EXPECT_NE(text.find("tool shift        1.0000 +- 0.1000,"), std::string::npos) << text;
  EXPECT_NE(text.find("noise of a touch 0.2000 mm\n"), std::string::npos) << text;
}

TEST(CalibrationText, OfASensorEndsWithWhatAScenarioTakes) {
  ForceSensorFit fit;
  fit.mass = 1.25;
  fit.force_offset = Vector3(1.5, 0.0, -2.0);
  fit.force_noise = 0.3;
  fit.torque_noise = 0.02;
  const std::string text = format_text(fit, "ft_sensor", true);
  EXPECT_EQ(text.find("mass              1.2500 +- 0.0000 kg (given)\n"), 0U) << text;
  EXPECT_NE(
      text.find("sensor: {force_noise: 0.3, torque_noise: 0.02, force_bias: [1.5, 0, -2], torque_bias: [0, 0, 0]}\n"),
      std::string::npos)
      << text;
  EXPECT_EQ(json::parse(format_json(fit)).at("force_offset_N").at(2), -2.0);
}

TEST(CalibrationText, OfAnArmSaysOnlyWhatWasAsked) {
  ArmReport report;
  report.origins = {0.001, 0.002};
  EXPECT_FALSE(json::parse(format_json(report, nominal())).contains("deviations"));
  report.end_error = FrameShift{1e-9, 2e-9};
  EXPECT_EQ(format_text(report, nominal()).find("tool against the deviations: at most 1e-09 m, 2e-09 rad apart\n"), 0U);
  IdentifiedArm found;
  found.deviations = Eigen::VectorXd::Constant(deviation_count(nominal()), 0.001);
  found.covariance = Eigen::MatrixXd::Identity(found.deviations.size(), found.deviations.size()) * 1e-8;
  report.found = found;
  const json written = json::parse(format_json(report, nominal()));
  EXPECT_EQ(written.at("deviations").size(), static_cast<std::size_t>(deviation_count(nominal())));
  EXPECT_NEAR(written.at("deviations").at(0).at("standard_deviation").get<double>(), 1e-4, 1e-18);
  EXPECT_EQ(written.at("max_frame_shift_m"), 0.001);
}

TEST(CalibrationText, OfACameraIsABlockWithItsErrors) {
  HandEye found;
  found.X_WC.p = Vector3(0.1, 0.2, 0.3);
  found.covariance = Matrix6::Identity() * 1e-6;
  const std::string block = format_camera_block(found, "tote", "ideal");
  EXPECT_NE(block.find("- name: tote\n    preset: ideal\n    pose: {position: [0.1000000, 0.2000000, 0.3000000]"),
            std::string::npos)
      << block;
  EXPECT_NE(block.find("hand_eye: {position: 0.001, rotation_deg: 0.0573}"), std::string::npos) << block;
  EXPECT_EQ(json::parse(format_json(found, 7)).at("rows"), 7);
  EXPECT_NE(format_text(found, 7).find("camera in W: at (100.000, 200.000, 300.000) mm +- (1.000, "),
            std::string::npos);
}

TEST(RequireFrames, NamesTheLinkThatIsMeantAndRefusesOnesThatMove) {
  try {
    (void)require_link(nominal(), "--end", "tool1");
    FAIL() << "there is no such link";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nearest is 'tool0'"), std::string::npos) << error.what();
  }
  EXPECT_EQ(require_frames(nominal(), "base", "tool0").end, robot::find_link(nominal(), "tool0"));
  EXPECT_THROW((void)require_frames(nominal(), "tool0", "tool0"), InputError) << "the base moves";
  EXPECT_THROW((void)require_frames(nominal(), "base", "base"), InputError) << "the end does not";
}

}  // namespace
}  // namespace snug::calibration
