// What was identified as text: keys and units for programs, warnings for people, verdicts at their limits.
#include "snug/identification/cup_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "snug/identification/parameter.hpp"
#include "snug/identification/payload_file.hpp"
#include "snug/identification/scenario_block.hpp"
#include "snug/identification/scene_text.hpp"

namespace snug::identification {
namespace {

using nlohmann::json;

bool has_text(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Verdict, ChangesAtFiveAndTwentyFivePercentOfTheScale) {
  EXPECT_EQ(judge(0.0, 1.0), Verdict::Identified);
  EXPECT_EQ(judge(4.99, 100.0), Verdict::Identified);
  EXPECT_EQ(judge(5.0, 100.0), Verdict::Weak);
  EXPECT_EQ(judge(24.99, 100.0), Verdict::Weak);
  EXPECT_EQ(judge(25.0, 100.0), Verdict::NotIdentifiable);
  // What is not known is not called known.
  EXPECT_EQ(judge(std::nan(""), 1.0), Verdict::NotIdentifiable);
  EXPECT_EQ(judge(std::numeric_limits<double>::infinity(), 1.0), Verdict::NotIdentifiable);
  EXPECT_EQ(judge(0.0, 0.0), Verdict::NotIdentifiable);
  EXPECT_STREQ(name_of(Verdict::NotIdentifiable), "not identifiable");
}

TEST(Verdict, OfAnErrorAndItsScaleInOtherUnitsIsTheSame) {
  for (const double error : {0.01, 0.1, 0.4})
    for (const double unit : {1e-6, 1e6}) EXPECT_EQ(judge(error, 1.0), judge(unit * error, unit));
}

StiffnessFit some_stiffness() {
  StiffnessFit fit;
  fit.parameters = {{"k_lat", 2300.0, 12.0, "N/m", Verdict::Identified, ""},
                    {"c", -20.0, 40.0, "N/rad", Verdict::Weak, "tilted poses"}};
  fit.K = Matrix6::Identity();
  fit.K(0, 4) = fit.K(4, 0) = -20.0;
  fit.chi2_per_dof = 1.25;
  fit.degrees_of_freedom = 595;
  fit.position = 0.0009;
  fit.rotation = 0.01;
  fit.poses = 100;
  fit.outliers = {3, 17};
  return fit;
}

TEST(CupText, HasUnitsOfItsKeys) {
  const json written = json::parse(format_json(some_stiffness(), {1.1, 0.002, 0.01}, true));
  EXPECT_EQ(written["parameters"][0]["name"], "k_lat");
  EXPECT_EQ(written["parameters"][0]["value"], 2300.0);
  EXPECT_EQ(written["parameters"][1]["verdict"], "weak");
  EXPECT_EQ(written["parameters"][1]["record_instead"], "tilted poses");
  EXPECT_FALSE(written["parameters"][0].contains("record_instead"));
  EXPECT_NEAR(written["held_back_position_mm"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(written["held_back_rotation_deg"].get<double>(), 0.5729577951308232, 1e-12);
  EXPECT_NEAR(written["residual_position_mm"].get<double>(), 0.9, 1e-12);
  EXPECT_EQ(written["outliers"], json({3, 17}));
  EXPECT_EQ(written["K"][0][4], -20.0);
  EXPECT_EQ(written["K"].size(), 6U);
  EXPECT_EQ(written["noise_is_given"], true);
  EXPECT_FALSE(written.contains("symmetry"));
  EXPECT_FALSE(written.contains("sensor_bias"));
}

TEST(CupText, TellsOfABiasAndASymmetryThatWereTested) {
  StiffnessFit fit = some_stiffness();
  fit.bias = SensorBias{
      {Vector3(1.0, 2.0, 3.0), Vector3(0.1, 0.2, 0.3)}, {Vector3::Ones(), Vector3::Ones()}, true, 50.0, 3.5, true};
  fit.symmetry = SymmetryTest{40.0, 0.0007, false, "k_x_x - k_y_y = 90 +- 10"};
  const json written = json::parse(format_json(fit, {}, false));
  EXPECT_EQ(written["sensor_bias"]["wrench_E"], json({1.0, 2.0, 3.0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(written["sensor_bias"]["against"], "gravity");
  EXPECT_EQ(written["sensor_bias"]["chi2_per_number_without"], 3.5);
  EXPECT_EQ(written["symmetry"]["degrees_of_freedom"], 16);
  const std::string text = format_table(fit, {}, false);
  EXPECT_TRUE(has_text(text, "the sensor is not tared")) << text;
  EXPECT_TRUE(has_text(text, "differ by more than a constant"));
  EXPECT_TRUE(has_text(text, "NOT supported"));
  EXPECT_TRUE(has_text(text, "assumed (the demonstrator's sensors)"));
  fit.bias->is_against_gravity = false;
  EXPECT_FALSE(json::parse(format_json(fit, {}, false))["sensor_bias"].contains("chi2_per_number_without"));
  EXPECT_TRUE(has_text(format_table(fit, {}, false), "sensor against the law"));
}

TEST(CupText, WarnsPeople) {
  StiffnessFit fit = some_stiffness();
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "left out, beyond 6 standard deviations of the rest: poses 3, 17"));
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "record instead: tilted poses"));
  EXPECT_FALSE(has_text(format_table(fit, {}, true), "NOT explained"));
  fit.chi2_per_dof = 2.5;
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "more than noise; standard errors are enlarged"));
  fit.chi2_per_dof = 0.2;
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "less than noise"));
  fit.is_explained = false;
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "do not use any number"));
}

DampingFit some_damping() {
  DampingFit fit;
  fit.parameters = {{"d_bend", 0.04, 0.001, "Nms/rad", Verdict::Identified, ""}};
  ReleaseFit first;
  first.name = "a.json case 0";
  first.parameters = fit.parameters;
  first.position = 0.0005;
  ReleaseFit second = first;
  second.name = "a.json case 1";
  second.outliers = {200};
  fit.releases = {first, second};
  fit.start = ReleaseStart::Moving;
  return fit;
}

TEST(CupText, OfDampingTellsEachRelease) {
  DampingFit fit = some_damping();
  const json written = json::parse(format_json(fit, {1.0, 0.001, 0.002}, true));
  EXPECT_EQ(written["start"], "moving");
  EXPECT_EQ(written["releases_agree"], true);
  ASSERT_EQ(written["releases"].size(), 2U);
  EXPECT_NEAR(written["releases"][0]["residual_position_mm"].get<double>(), 0.5, 1e-12);
  EXPECT_EQ(written["releases"][1]["outliers"], json({200}));
  std::string text = format_table(fit, {}, true);
  EXPECT_TRUE(has_text(text, "damping from 2 releases, moving when the records begin")) << text;
  EXPECT_TRUE(has_text(text, "a.json case 1: chi2"));
  EXPECT_TRUE(has_text(text, "samples left out: 200"));
  EXPECT_FALSE(has_text(text, "contradict"));
  fit.releases_agree = false;
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "the releases contradict each other"));
  fit.releases.resize(1);
  EXPECT_TRUE(has_text(format_table(fit, {}, true), "from 1 release,"));
}

SceneFit some_scene() {
  SceneFit fit;
  fit.parameters = {{"friction", 0.31, 0.004, "", Verdict::Identified, ""},
                    {"mass", 0.8, std::numeric_limits<double>::infinity(), "", Verdict::NotIdentifiable, "fix it"},
                    {"size", 0.2, std::nan(""), "", Verdict::NotIdentifiable, "held fixed by the task"}};
  fit.values = Eigen::Vector3d(0.31, 0.8, 0.2);
  fit.covariance = Eigen::Matrix3d::Zero();
  fit.covariance(0, 0) = 1.6e-5;
  fit.covariance(1, 1) = 0.01;
  fit.covariance(0, 1) = fit.covariance(1, 0) = -0.9 * 4e-3 * 0.1;
  fit.chi2_per_dof = 1.1;
  fit.held_back_error = std::nan("");
  fit.fitted = {.position_mm = 1.5, .rotation_deg = 0.5, .cost = 1.7, .recordings = 4};
  fit.unknown = {{{{"mass", 0.7}, {"size", -0.7}}, std::numeric_limits<double>::infinity()}};
  fit.unpredictable = {{"toss 1", "parcel", 0.6}, {"toss 2", "parcel", 0.4}};
  fit.rejected = {{"toss 1", "parcel", 3}};
  fit.smoothed = {{"toss 1", "pusher", 1e-4, 1e-3, 12.0, 8.0}, {"toss 2", "pusher", 3e-4, 1e-3, 14.0, 8.0}};
  fit.profiles = {
      {"friction", {0.3, 0.31, 0.32}, {4.0, 0.0, std::nan("")}, 0.302, std::numeric_limits<double>::infinity()}};
  fit.message = "settled";
  return fit;
}

TEST(SceneText, HasNullForWhatIsInfiniteOrUnknown) {
  const json written = json::parse(format_json(some_scene()));
  EXPECT_TRUE(written["parameters"][1]["standard_error"].is_null());
  EXPECT_TRUE(written["parameters"][2]["standard_error"].is_null());
  EXPECT_TRUE(written["held_back_error"].is_null());
  EXPECT_TRUE(written["refused"][0]["error_in_bounds"].is_null());
  EXPECT_EQ(written["refused"][0]["shares_of_bounds"]["size"], -0.7);
  EXPECT_TRUE(written["profiles"][0]["high_95"].is_null());
  EXPECT_TRUE(written["profiles"][0]["rises"][2].is_null());
  EXPECT_FALSE(written.contains("held_back"));  // nothing was
  EXPECT_EQ(written["fitted"]["recordings"], 4);
  EXPECT_EQ(written["covariance"].size(), 3U);
  EXPECT_NEAR(written["smoothed"][0]["rotation_noise_deg"].get<double>(), 0.0572957795, 1e-9);
}

TEST(SceneText, TellsCorrelationsOfPairsThatHaveErrors) {
  const json written = json::parse(format_json(some_scene()));
  ASSERT_EQ(written["correlations"].size(), 1U);  // what is fixed has none
  EXPECT_EQ(written["correlations"][0]["a"], "friction");
  EXPECT_NEAR(written["correlations"][0]["correlation"].get<double>(), -0.9, 1e-12);
  EXPECT_TRUE(has_text(format_table(some_scene()), "correlation of friction and mass: -0.900"));
  SceneFit loose = some_scene();
  loose.covariance(0, 1) = loose.covariance(1, 0) = 0.5 * 4e-3 * 0.1;
  EXPECT_FALSE(has_text(format_table(loose), "correlation of"));
}

TEST(SceneText, TellsPeopleWhatWasDoneToTheRecordings) {
  const std::string text = format_table(some_scene());
  EXPECT_TRUE(has_text(text, "left out: parcel from 0.40 s on, in 2 recordings")) << text;
  EXPECT_TRUE(has_text(text, "rejected: 3 samples of parcel in toss 1"));
  EXPECT_TRUE(has_text(text, "noise of 0.200 mm and 0.057 deg found, 13 and 8 Hz"));
  EXPECT_TRUE(has_text(text, "refused, the recordings do not tell: +0.70 mass -0.70 size"));
  EXPECT_TRUE(has_text(text, "not told"));
  EXPECT_TRUE(has_text(text, "fixed"));
  EXPECT_TRUE(has_text(text, "95 % of friction by its profile: 0.302 to inf"));
}

TEST(SceneText, SaysWhenNumbersAreNotToBeTrusted) {
  SceneFit fit = some_scene();
  EXPECT_FALSE(has_text(format_table(fit), "NOT to be trusted"));
  fit.is_trusted = false;
  fit.is_systematic = true;
  fit.chi2_per_dof = 9.0;
  const std::string text = format_table(fit);
  EXPECT_TRUE(has_text(text, "NOT to be trusted"));
  EXPECT_TRUE(has_text(text, "residuals are correlated"));
  EXPECT_TRUE(has_text(text, "more than noise, no number is called identified"));
  fit.chi2_per_dof = 0.3;
  EXPECT_TRUE(has_text(format_table(fit), "the noise is smaller than the task says"));
}

TEST(SceneText, OfAnErrorCountsWhatCouldNotBeSimulated) {
  SceneError error{
      .position_mm = 2.0, .rotation_deg = 1.0, .right_orientation_percent = 50.0, .cost = 3.0, .recordings = 1};
  EXPECT_EQ(format_table(error), "2.000 mm, 1.000 degrees, right orientation 50.0 %, cost 3.0000 mm, 1 recording\n");
  error.recordings = 3;
  error.failed = 2;
  EXPECT_TRUE(has_text(format_table(error), "3 recordings, 2 of them could not be simulated"));
  const json written = json::parse(format_json(error));
  EXPECT_EQ(written["failed"], 2);
  EXPECT_EQ(written["position_mm"], 2.0);
}

TEST(PayloadText, SaysUnknownBeforeTheFirstWindow) {
  const json written = json::parse(format_payload_json({}));
  ASSERT_EQ(written["parameters"].size(), 10U);
  for (const json& one : written["parameters"]) {
    EXPECT_TRUE(one["standard_error"].is_null()) << one;
    EXPECT_EQ(one["verdict"], "not identifiable") << one;
  }
  EXPECT_EQ(written["windows"], 0);
  EXPECT_TRUE(has_text(format_payload_table({}), "+- unknown"));
}

TEST(PayloadText, JudgesCentresInMetresAndMomentsByTheirMean) {
  PayloadEstimate estimate;
  estimate.windows = 5;
  estimate.load_S = {1.0, Vector3(0.0, 0.0, 0.05), Vector3(0.002, 0.004, 0.006).asDiagonal()};
  Eigen::Matrix<double, 10, 1> deviation;
  // Of the mean of the moments, 0.004: 5 % are 2e-4, 25 % are 1e-3.
  deviation << 0.04, 0.0049, 0.0199, 0.0201, 1.9e-4, 2.1e-4, 1.1e-3, 1.9e-4, 9e-4, 2e-3;
  estimate.covariance.diagonal() = deviation.cwiseAbs2();
  const Verdict verdicts[] = {Verdict::Identified,      Verdict::Identified, Verdict::Weak,
                              Verdict::NotIdentifiable, Verdict::Identified, Verdict::Weak,
                              Verdict::NotIdentifiable, Verdict::Identified, Verdict::Weak,
                              Verdict::NotIdentifiable};
  const std::vector<Parameter> told = judge_payload(estimate);
  ASSERT_EQ(told.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(told[i].verdict, verdicts[i]) << told[i].name;
    EXPECT_EQ(told[i].advice.empty(), verdicts[i] == Verdict::Identified) << told[i].name;
  }
  EXPECT_EQ(told[4].value, 0.002);
  EXPECT_EQ(told[6].name, "I_zz");
}

TEST(BlockEntries, AreThoseThatAScenarioHasKeysFor) {
  const std::vector<Parameter> parameters = {{"k_ax", 1.0, 0.1, "N/m", Verdict::Weak, ""},
                                             {"k_x_ry", 2.0, 0.1, "N/rad", Verdict::Weak, ""},
                                             {"c", 3.0, 0.1, "N/rad", Verdict::Identified, ""},
                                             {"d_c", 4.0, 0.1, "Ns/rad", Verdict::Identified, ""}};
  const std::vector<BlockEntry> stiffness = block_entries(parameters, 'k'), damping = block_entries(parameters, 'd');
  ASSERT_EQ(stiffness.size(), 2U);
  EXPECT_EQ(stiffness[0].key, "axial");
  EXPECT_EQ(stiffness[1].key, "coupling");
  EXPECT_EQ(stiffness[1].value, 3.0);
  ASSERT_EQ(damping.size(), 1U);
  EXPECT_EQ(damping[0].key, "coupling");
  EXPECT_EQ(damping[0].value, 4.0);
}

}  // namespace
}  // namespace snug::identification
