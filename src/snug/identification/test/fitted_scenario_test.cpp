// FittedScenario: half widths of uniform draws from standard errors, shrunk only where all of a key's numbers are
// known.
#include "snug/identification/fitted_scenario.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "snug/core/test/scratch_folder.hpp"
#include "snug/identification/scene_page.hpp"

namespace snug::identification {
namespace {

constexpr const char* kTwoPairs = R"(name: two pairs
duration: 1.0
materials: [{name: box}, {name: floor}]
contacts:
  pairs:
    - {between: [box, floor], friction: 0.4, restitution: 0.0, stiffness: 20000}
    - {between: [box, box], friction: 0.5, restitution: 0.0}
cup: {free_length: 0.06, hold_length: 0.05}
bodies:
  - {name: floor, kind: static, size: [8, 2, 0.1], material: floor, pose: {position: [0, 0, -0.05]}}
  - {name: parcel, size: [0.2, 0.2, 0.1], mass: 0.5, material: box, pose: {position: [0, 0, 0.05]}}
uncertainty: {friction: 0.2, contact_stiffness: 0.3, cup_length: 0.0005}
)";

class FittedScenarioTest : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "scene.yaml") << kTwoPairs; }

  /// A task of these parameters with a recording of a box at rest.
  [[nodiscard]] SceneExperiment experiment(const std::string& parameters) const {
    RecordedMotion motion;
    motion.name = "rest";
    motion.tracked.push_back({"parcel", {}, {}, {}});
    for (int k = 0; k < 5; ++k) {
      motion.times.push_back(0.1 * k);
      motion.tracked[0].poses.emplace_back(Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.05)});
    }
    return {model::parse_scene_task("scenario: scene.yaml\ntracked_objects: [{body: parcel}]\n"
                                    "start: {from: scenario}\nparameters:\n" +
                                        parameters,
                                    folder_ / "task.yaml"),
            {motion},
            1};
  }

  /// What a fit with these errors, each identified, leaves uncertain.
  static FittedScenario with_errors(const SceneExperiment& experiment, const std::vector<double>& errors) {
    SceneFit fit;
    fit.values = experiment.start();
    for (std::size_t i = 0; i < errors.size(); ++i)
      fit.parameters.push_back({experiment.task().parameters[i].name, fit.values[static_cast<Eigen::Index>(i)],
                                errors[i], "", Verdict::Identified, ""});
    return fitted_scenario(experiment, fit);
  }

  snug::test::ScratchFolder folder_;
};

constexpr const char* kBothFrictions =
    "  - {name: mu1, path: \"contacts.pairs[0].friction\", value: 0.4, bounds: [0.05, 0.8]}\n"
    "  - {name: mu2, path: \"contacts.pairs[1].friction\", value: 0.5, bounds: [0.05, 0.8]}\n";

TEST_F(FittedScenarioTest, HasTheWidestOfSharesWhereAllNumbersWereFound) {
  const FittedScenario fitted = with_errors(experiment(kBothFrictions), {0.004, 0.002});
  ASSERT_EQ(fitted.changes.size(), 1U);
  EXPECT_EQ(fitted.changes[0].key, "friction");
  EXPECT_EQ(fitted.changes[0].before, 0.2);
  // A uniform draw of half width w has a deviation of w / sqrt(3): 0.004 of 0.4 is the wider share.
  EXPECT_NEAR(fitted.changes[0].after, std::sqrt(3.0) * 0.01, 1e-12);
  EXPECT_NEAR(fitted.scenario.uncertainty.friction, std::sqrt(3.0) * 0.01, 1e-4);
  EXPECT_EQ(fitted.scenario.uncertainty.contact_stiffness, 0.3);
}

TEST_F(FittedScenarioTest, DoesNotShrinkWhatOthersMayBe) {
  const SceneExperiment one =
      experiment("  - {name: mu1, path: \"contacts.pairs[0].friction\", value: 0.4, bounds: [0.05, 0.8]}\n");
  EXPECT_TRUE(with_errors(one, {0.004}).changes.empty());
  // But one number that is known worse than the scenario says widens it for all.
  const FittedScenario wide = with_errors(one, {0.08});
  ASSERT_EQ(wide.changes.size(), 1U);
  EXPECT_NEAR(wide.changes[0].after, std::sqrt(3.0) * 0.2, 1e-12);
  // Not wider than everything.
  EXPECT_EQ(with_errors(one, {5.0}).changes[0].after, 1.0);
}

TEST_F(FittedScenarioTest, LeavesOutWhatIsNotKnown) {
  const SceneExperiment both = experiment(kBothFrictions);
  SceneFit fit;
  fit.values = both.start();
  fit.parameters = {{"mu1", 0.4, 0.004, "", Verdict::Identified, ""},
                    {"mu2", 0.5, 0.002, "", Verdict::NotIdentifiable, ""}};
  EXPECT_TRUE(fitted_scenario(both, fit).changes.empty());  // one of two
  fit.parameters[1] = {"mu2", 0.5, std::numeric_limits<double>::infinity(), "", Verdict::Weak, ""};
  EXPECT_TRUE(fitted_scenario(both, fit).changes.empty());
}

TEST_F(FittedScenarioTest, OfAScaleIsTheErrorOfTheNumberItself) {
  const SceneExperiment scale = experiment(
      "  - {name: stiffer, form: scale, path: \"contacts.pairs[0].stiffness\", value: 1.5, bounds: [0.5, 2]}\n");
  // 0.03 of 1.5 is 2 % of the number, whatever that is: the only pair that gives way.
  const FittedScenario fitted = with_errors(scale, {0.03});
  ASSERT_EQ(fitted.changes.size(), 1U);
  EXPECT_EQ(fitted.changes[0].key, "contact_stiffness");
  EXPECT_NEAR(fitted.changes[0].after, std::sqrt(3.0) * 0.02, 1e-12);
  EXPECT_DOUBLE_EQ(*fitted.scenario.contact_pairs[0].params.stiffness, 30000.0);
}

TEST_F(FittedScenarioTest, OfLengthsIsInMetres) {
  const SceneExperiment lengths = experiment(
      "  - {name: free, path: cup.free_length, value: 0.06, bounds: [0.055, 0.07]}\n"
      "  - {name: hold, path: cup.hold_length, value: 0.05, bounds: [0.04, 0.055]}\n");
  const FittedScenario fitted = with_errors(lengths, {1e-4, 5e-5});
  ASSERT_EQ(fitted.changes.size(), 1U);
  EXPECT_EQ(fitted.changes[0].key, "cup_length");
  EXPECT_NEAR(fitted.changes[0].after, std::sqrt(3.0) * 1e-4, 1e-12);
}

TEST_F(FittedScenarioTest, TouchesNoKeyForNumbersThatHaveNone) {
  const SceneExperiment mass = experiment("  - {name: mass, path: bodies.parcel.mass, value: 0.6, bounds: [0.1, 2]}\n");
  const FittedScenario fitted = with_errors(mass, {0.2});
  EXPECT_TRUE(fitted.changes.empty());
  EXPECT_EQ(fitted.scenario.uncertainty, mass.scenario_at(mass.start()).uncertainty);
  EXPECT_EQ(model::find_body(fitted.scenario, "parcel")->inertia.mass, 0.6);
}

TEST_F(FittedScenarioTest, IsReadAgainFromItsText) {
  const FittedScenario fitted = with_errors(experiment(kBothFrictions), {0.0123456, 0.002});
  const model::Scenario again = model::parse_scenario(fitted.scenario.source_text, "again");
  EXPECT_EQ(again.uncertainty, fitted.scenario.uncertainty);
  EXPECT_EQ(again.contact_pairs[1].params.friction, 0.5);
}

TEST_F(FittedScenarioTest, HasAPageThatNamesWhatIsNotToBeUsedAndEscapesNames) {
  const SceneExperiment both = experiment(kBothFrictions);
  SceneFit fit;
  fit.values = both.start();
  fit.parameters = {{"mu1", 0.4, 0.004, "", Verdict::Identified, ""},
                    {"<script>", 0.5, std::numeric_limits<double>::infinity(), "", Verdict::NotIdentifiable, "a & b"}};
  fit.chi2_per_dof = 1.0;
  fit.fitted = {.position_mm = 1.0, .recordings = 2};
  const std::string sound = make_page(both, fit, {});
  EXPECT_NE(sound.find("The simulation explains the recordings."), std::string::npos);
  EXPECT_NE(sound.find("not told"), std::string::npos);
  EXPECT_NE(sound.find("uncertainty of the scenario does not change"), std::string::npos);
  EXPECT_NE(sound.find("&lt;script&gt;"), std::string::npos);
  EXPECT_NE(sound.find("a &amp; b"), std::string::npos);
  EXPECT_EQ(sound.find("error on recordings held back"), std::string::npos);
  fit.is_trusted = false;
  EXPECT_NE(make_page(both, fit, {}).find("do not use these numbers"), std::string::npos);
  fit.is_trusted = true;
  fit.chi2_per_dof = 2.0;
  fit.held_back = fit.held_back_before = {.position_mm = 2.0, .recordings = 1};
  const std::string noisy = make_page(both, fit, {{"friction", 0.2, 0.0173}});
  EXPECT_NE(noisy.find("This is more than noise"), std::string::npos);
  EXPECT_NE(noisy.find("error on recordings held back"), std::string::npos);
  EXPECT_NE(noisy.find("0.0173"), std::string::npos);
}

}  // namespace
}  // namespace snug::identification
