// What was found of releases and laws as text, and what a pluck is planned of.
#include "snug/identification/fit_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/identification/scenario_block.hpp"
#include "snug/identification/virtual_experiments.hpp"

namespace snug::identification {
namespace {

using nlohmann::json;

ReleaseErrors one_mass(double recorded_opening) {
  ReleaseErrors errors;
  errors.rms = 0.0015;
  errors.opening_error = recorded_opening < 0.0 ? -1.0 : 0.002;
  errors.masses = {{0.5, 3, 0.0015, 0.0004, 0.03, recorded_opening}};
  return errors;
}

TEST(FitText, OfAReleaseLeavesOutAnOpeningThatWasNotSeen) {
  EXPECT_EQ(format_text(one_mass(0.031), "it"),
            "it: 1.50 mm rms of the box's heights, opening 2.0 ms rms\n"
            "   0.500 kg,   3 recordings:  1.50 mm (recordings scatter by 0.40), opens at  30.0 ms, recorded  31.0\n");
  EXPECT_EQ(format_text(one_mass(-1.0), "it"),
            "it: 1.50 mm rms of the box's heights\n"
            "   0.500 kg,   3 recordings:  1.50 mm (recordings scatter by 0.40), opens at  30.0 ms\n");
  EXPECT_TRUE(json::parse(format_json(one_mass(-1.0))).at("opening_ms_error").is_null());
  EXPECT_EQ(json::parse(format_json(one_mass(0.031))).at("masses").at(0).at("recorded_opening_ms"), 31.0);
}

TEST(FitText, OfAFitHasItsNumbersWithAdviceAndWhatWasHeldBack) {
  CupReleaseFit fit;
  fit.parameters = {{"growth", 0.03, 0.001, "m", Verdict::Identified, ""},
                    {"damping", 18.0, 9.0, "Ns/m", Verdict::Weak, "heavier"}};
  fit.errors = fit.held_back = one_mass(-1.0);
  const json written = json::parse(format_json(fit));
  EXPECT_FALSE(written.at("parameters").at(0).contains("record_instead"));
  EXPECT_EQ(written.at("parameters").at(1).at("record_instead"), "heavier");
  EXPECT_EQ(written.at("held_back").at("rms_mm"), 1.5);
  EXPECT_NE(format_text(fit).find("      record as well: heavier\nfitted: "), std::string::npos) << format_text(fit);
}

TEST(FitText, OfALawSaysWhichComponentsItDoesNotExplain) {
  PoseErrors errors;
  errors.normalised = 0.2;
  EXPECT_EQ(verdict_of(errors), "this law explains these data");
  errors.components(1) = errors.components(5) = 0.6;
  EXPECT_EQ(verdict_of(errors), "this law does not explain these data: fy, tz");
  const json written = json::parse(format_json(errors));
  EXPECT_EQ(written.at("is_explained"), false);
  EXPECT_EQ(written.at("components").at("tz"), 0.6);
  EXPECT_NE(format_text(errors, "the law").find("  fx 0.000 fy 0.600"), std::string::npos)
      << format_text(errors, "the law");
}

TEST(BlockEntries, OfAFitWith21NumbersHaveTheErrorsOfTheEntriesTheyAreReadFrom) {
  StiffnessFit fit;
  fit.elasticity.lateral = 1000.0;
  for (int i = 0; i < 21; ++i) fit.parameters.push_back({"other", 0.0, 0.0, "", Verdict::Weak, ""});
  fit.parameters[0] = {"k_x_x", 1010.0, 5.0, "N/m", Verdict::Identified, ""};
  const std::vector<BlockEntry> entries = block_entries(fit);
  ASSERT_FALSE(entries.empty());
  EXPECT_EQ(entries[0].value, 1000.0) << "of the nearest cup that looks the same from all sides";
  EXPECT_EQ(entries[0].standard_error, 5.0);
}

TEST(PlanPluck, HoldsTheBoxByItsUpperFaceAndKnowsHowFarACupIsPulled) {
  const SpatialInertia box{0.5, Vector3(0.01, 0.02, -0.03), Vector3(1e-3, 2e-3, 3e-3).asDiagonal()};
  const Vector3 size(0.2, 0.2, 0.1);
  const Pluck pluck = plan_pluck({}, size, box, pluck_direction_of("axial"), {});
  EXPECT_NEAR((pluck.load_S.com - Vector3(0.01, -0.02, 0.08)).norm(), 0.0, 1e-15) << "below the lip: Sz points down";
  EXPECT_EQ(pluck.amplitude, 0.004);
  EXPECT_EQ(plan_pluck({}, size, box, pluck_direction_of("torsion"), {}).amplitude, 0.1);
  EXPECT_THROW((void)plan_pluck({}, size, box, PluckDirection::Axial, 0.031), InputError);
  EXPECT_NO_THROW((void)plan_pluck({}, size, box, PluckDirection::Bend, 0.5));
  const std::vector<Release> plucks = make_plucks(pluck, 2, {}, 1);
  ASSERT_EQ(plucks.size(), 2U);
  EXPECT_NE(plucks[0].X_ES[5].p, plucks[1].X_ES[5].p) << "noise of its own";
  EXPECT_EQ(plucks[0].X_ES[5].p, make_plucks(pluck, 1, {}, 1)[0].X_ES[5].p);
}

}  // namespace
}  // namespace snug::identification
