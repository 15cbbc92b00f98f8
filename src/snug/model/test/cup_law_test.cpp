#include "snug/model/cup_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/model/cup_params.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/test/compressible_cup.hpp"

namespace snug::model {
namespace {

TEST(CupLaw, SlopesAndCurvaturesAreDerivativesInsideAndOutsideOfTheMeasuredRange) {
  const CupLaw law = test::compressible_cup();
  const double h = 1e-7;
  for (double z = -0.035; z < 0.02; z += 0.00061) {
    for (const auto curve : {&CupLaw::axial, &CupLaw::lateral, &CupLaw::bend, &CupLaw::coupling, &CupLaw::torsion}) {
      const Curve at = (law.*curve)(z), before = (law.*curve)(z - h), after = (law.*curve)(z + h);
      EXPECT_NEAR(at.slope, (after.value - before.value) / (2.0 * h), 1e-5 * std::abs(at.slope) + 1e-3) << z;
      EXPECT_NEAR(at.curvature, (after.slope - before.slope) / (2.0 * h), 1e-5 * std::abs(at.curvature) + 1.0) << z;
    }
  }
}

TEST(CupLaw, NothingPullsWhereNothingIsDeformed) {
  const Curve rest = test::compressible_cup().axial(0.0);
  EXPECT_EQ(rest.value, 0.0);
  EXPECT_EQ(rest.slope, 0.0);
  EXPECT_EQ(undeformed_stiffness(test::compressible_cup()).axial, rest.curvature);
}

TEST(CupLaw, StiffnessesEndBeyondTheMeasuredRangeAndTheAxialForceGoesOnStraight) {
  const CupLaw law = test::compressible_cup();
  const double at_the_end = 1200.0 + 300.0 * 1.25 + 100.0 * 1.25 * 1.25;
  EXPECT_NEAR(law.lateral(law.middle + 1e3 * law.half_range).value, at_the_end, 1e-3);
  const double end = law.axial(law.middle + law.half_range).curvature;
  EXPECT_NEAR(law.axial(law.middle + 30.0 * law.half_range).curvature, end, 1e-9 * end);
}

TEST(CupLaw, ScaledIsEveryForceTimesTheFactor) {
  CupLaw law = test::compressible_cup();
  law.scale(0.25);
  for (const double z : {-0.02, -0.009, 0.004}) {
    EXPECT_NEAR(law.axial(z).slope, 0.25 * test::compressible_cup().axial(z).slope, 1e-12);
    EXPECT_NEAR(law.coupling(z).value, 0.25 * test::compressible_cup().coupling(z).value, 1e-12);
  }
}

std::string scene_with(const std::string& cup) { return "name: s\nmaterials: [{name: board}]\ncup:\n" + cup; }
const std::string kLaw =
    "  law: {half_range: 0.007, middle: -0.007, axial_1: 20, lateral_0: 1200, bend_0: 0.8, torsion_0: 0.2}\n";

std::string complaint_about(const std::string& cup) {
  try {
    (void)parse_scenario(scene_with(cup), "s.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CupLaw, IsReadAndPlanningTakesItsStiffnessAtRest) {
  const Scenario scenario = parse_scenario(scene_with(kLaw), "s.yaml");
  EXPECT_TRUE(scenario.cup.law.is_used());
  EXPECT_NEAR(scenario.cup.stiffness.axial, 20.0 / 0.007, 1e-9);
  EXPECT_EQ(scenario.cup.stiffness.lateral, 1200.0);
  EXPECT_FALSE(parse_scenario(scene_with("  hold_length: 0.05\n"), "s.yaml").cup.law.is_used());
}

TEST(CupLaw, ComplaintsNameWhatIsWrong) {
  EXPECT_NE(complaint_about("  law: {axial_1: 20}\n").find("half_range"), std::string::npos);
  EXPECT_NE(complaint_about("  stiffness: {lateral: 2}\n" + kLaw).find("stiffness beside law"), std::string::npos);
  const std::string buckles =
      "  law: {half_range: 0.007, axial_1: 20, lateral_0: 1200, bend_0: 0.8, torsion_0: 0.2, coupling_0: 40}\n";
  EXPECT_NE(complaint_about(buckles).find("coupling^2"), std::string::npos);
  const std::string gives_way =
      "  law: {half_range: 0.007, axial_1: 20, lateral_0: 1200, lateral_1: 1000, bend_0: 0.8, torsion_0: 0.2}\n";
  EXPECT_NE(complaint_about(gives_way).find("for u from -2 to 2"), std::string::npos);
  const std::string falls =
      "  law: {half_range: 0.007, axial_1: 20, axial_3: -20, lateral_0: 1200, bend_0: 0.8, torsion_0: 0.2}\n";
  EXPECT_NE(complaint_about(falls).find("axial stiffness"), std::string::npos);
  EXPECT_NE(complaint_about("  law: {half_rang: 0.007}\n").find("half_range"), std::string::npos);
}

}  // namespace
}  // namespace snug::model
