// Starting cups from data sheets: scaling, ranges, and blocks that load.
#include "snug/cup/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/cup/suction_cup.hpp"
#include "snug/model/scenario.hpp"

namespace snug::cup {
namespace {

TEST(CupEstimate, GivesRangesThatHoldTheirValuesForEveryCupOfTheCatalogue) {
  const std::vector<CupSheet> cups = cup_catalogue();
  ASSERT_EQ(cups.size(), 36u);
  for (const CupSheet& sheet : cups) {
    const CupEstimate estimate = estimate_cup(sheet);
    for (const Estimate& one : estimate.estimates) {
      EXPECT_LE(one.low, one.value) << one.name;
      EXPECT_LE(one.value, one.high) << one.name;
    }
    // No cup holds more than the pressure on its whole lip.
    const double most = -sheet.pressure_gauge * 0.25 * std::numbers::pi * std::pow(sheet.diameter, 2);
    EXPECT_LE(estimate.pull_off.high, most * (1.0 + 1e-12));
    EXPECT_GT(estimate.pull_off.low, 0.4 * most);
    EXPECT_LT(estimate.lateral.high, estimate.pull_off.high);
    const auto& k = estimate.cup.stiffness;
    EXPECT_GT(k.lateral * k.bend, k.coupling * k.coupling);
  }
}

TEST(CupEstimate, WritesABlockThatAScenarioLoads) {
  for (CupSheet sheet : cup_catalogue()) {
    sheet.mass_max = 5.0;
    const CupEstimate estimate = estimate_cup(sheet);
    const std::string text = "materials: [{name: any}]\n" + format_estimate(sheet, estimate);
    const model::Scenario scenario = model::parse_scenario(text, "estimated");
    EXPECT_NEAR(scenario.cup.stiffness.axial / estimate.cup.stiffness.axial, 1.0, 1e-3);
    EXPECT_NEAR(scenario.cup.free_length / estimate.cup.free_length, 1.0, 1e-3);
    EXPECT_NEAR(scenario.uncertainty.cup_length / estimate.uncertainty.cup_length, 1.0, 1e-2);
  }
}

TEST(CupEstimate, HoldsTheMeasuredCupInItsRanges) {
  // 70 mm, 2.5 folds, foam lip: axial stiffness 6.81 kN/m and growth of 30 mm are measured, the effective diameter of
  // 55 to 70 mm is the demonstrator's own range.
  const CupEstimate estimate = estimate_cup({.diameter = 0.070, .bellows = 2.5, .lip = LipKind::Foam});
  const auto range_of = [&](const std::string& name) {
    for (const Estimate& one : estimate.estimates)
      if (one.name == name) return one;
    ADD_FAILURE() << name;
    return Estimate{};
  };
  EXPECT_LE(range_of("stroke").low, 0.0296);
  EXPECT_GE(range_of("stroke").high, 0.0296);
  EXPECT_LE(range_of("stiffness.axial").low, 6810.0);
  EXPECT_GE(range_of("stiffness.axial").high, 6810.0);
  EXPECT_LE(range_of("effective_diameter").low, 0.055);
  EXPECT_GE(range_of("effective_diameter").high, 0.060);
}

TEST(CupEstimate, RefusesWhatNoCupHas) {
  EXPECT_THROW((void)estimate_cup({.diameter = 0.001}), InputError);
  EXPECT_THROW((void)estimate_cup({.diameter = std::nan("")}), InputError);
  EXPECT_THROW((void)estimate_cup({.bellows = 2.0}), InputError);
  EXPECT_THROW((void)estimate_cup({.pressure_gauge = 6e4}), InputError);
  EXPECT_THROW((void)estimate_cup({.stroke = 0.5}), InputError);
  EXPECT_THROW((void)estimate_cup({.mass_max = -1.0}), InputError);
}

}  // namespace
}  // namespace snug::cup
