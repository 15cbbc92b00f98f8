// Grippers of several cups: what the reader takes and refuses, the supply's balance, one cup that stands for all.
#include "snug/model/gripper_params.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/model/scenario.hpp"

namespace snug::model {
namespace {

Scenario with(const std::string& gripper) {
  return parse_scenario(
      "name: g\nmaterials: [{name: box}]\ncup: {lip_radius: 0.02, effective_diameter: 0.03}\n" + gripper, "g.yaml");
}

/// What is said of it.
std::string refusal(const std::string& gripper) {
  try {
    (void)with(gripper);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

void expect_refused(const std::string& gripper, const std::vector<std::string>& words) {
  const std::string said = refusal(gripper);
  for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << said;
}

TEST(Gripper, HasTheCupsThatAreListedWithZonesAndOwnKeys) {
  const Scenario scenario = with(
      "gripper:\n  cups:\n    - {at: [0.1, 0.05], zone: A}\n"
      "    - {at: [-0.1, 0.05, 0.01], zone: B, name: left, cup: {lip_friction: 0.7}, check_valve: true}\n"
      "  supply: {flow: 2.0e-3}\n");
  ASSERT_TRUE(scenario.gripper);
  const GripperParams& gripper = *scenario.gripper;
  ASSERT_EQ(gripper.cups.size(), 2U);
  EXPECT_EQ(gripper.zones, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(gripper.cups[0].name, "1");
  EXPECT_EQ(gripper.cups[1].name, "left");
  EXPECT_EQ(gripper.cups[1].zone, 1U);
  EXPECT_EQ(gripper.cups[1].p_EC, Vector3(-0.1, 0.05, 0.01));
  EXPECT_EQ(gripper.cups[0].cup.lip_friction, 0.5);
  EXPECT_EQ(gripper.cups[1].cup.lip_friction, 0.7);
  EXPECT_EQ(gripper.cups[1].cup.lip_radius, 0.02);  // of `cup`
  EXPECT_TRUE(gripper.cups[1].line.check_valve);
  EXPECT_EQ(gripper.supply->pressure_gauge, -6.0e4);  // what the cups have alone
}

TEST(Gripper, OfAGridHasItsCupsAboutE) {
  const Scenario scenario = with("gripper: {grid: {columns: 4, rows: 3, pitch: [0.05, 0.04]}}\n");
  ASSERT_EQ(scenario.gripper->cups.size(), 12U);
  Vector3 sum = Vector3::Zero();
  for (const MountedCup& cup : scenario.gripper->cups) sum += cup.p_EC;
  EXPECT_LT(sum.norm(), 1e-12);
  EXPECT_EQ(scenario.gripper->cups[0].name, "1.1");
  EXPECT_NEAR(scenario.gripper->cups[11].p_EC.x(), 0.075, 1e-12);
  EXPECT_NEAR(footprint(*scenario.gripper).y(), 0.04 + 0.015, 1e-12);
}

TEST(Gripper, ThatCannotBeIsRefusedWithLineKeyAndWhatWasExpected) {
  expect_refused("gripper: {}\n", {"g.yaml:4", "cups", "grid"});
  expect_refused("gripper: {cups: []}\n", {"g.yaml:4", "at least one cup"});
  expect_refused("gripper:\n  cups:\n    - {att: [0, 0]}\n", {"g.yaml:6", "att", "'at'"});
  expect_refused("gripper:\n  cups:\n    - {at: [0]}\n", {"g.yaml:6", "[x, y]"});
  expect_refused("gripper:\n  cups:\n    - {at: [100, 0]}\n", {"g.yaml:6", "metres"});
  expect_refused("gripper:\n  cups:\n    - {at: [.nan, 0]}\n", {"g.yaml:6"});
  expect_refused("gripper: {cups: [{at: [0, 0]}, {at: [0.02, 0]}]}\n", {"g.yaml:4", "0.02 m apart", "0.03 m"});
  expect_refused("gripper: {cups: [{at: [0, 0], name: a}, {at: [0.2, 0], name: a}]}\n", {"'a'", "different names"});
  expect_refused("gripper: {grid: {columns: 100, rows: 100, pitch: 0.04}}\n", {"10000 cups", "256"});
  expect_refused("gripper: {grid: {columns: 2, rows: 2}}\n", {"pitch"});
  expect_refused("gripper: {cups: [{at: [0, 0]}], grid: {columns: 1, rows: 1, pitch: 0.1}}\n", {"grid"});
  expect_refused("gripper: {cups: [{at: [0, 0]}], supply: {}}\n", {"flow"});
  expect_refused("gripper: {cups: [{at: [0, 0]}], supply: {flow: 50}}\n", {"m^3/s"});
  expect_refused("gripper: {cups: [{at: [0, 0]}], supply: {flow: 1e-3, pressure_gauge: 100}}\n", {"pressure_gauge"});
  expect_refused("gripper: {cups: [{at: [0, 0], port_diameter: 4}]}\n", {"metres"});
  expect_refused("gripper: {cups: [{at: [0, 0], cup: {hold_length: 0.2}}]}\n", {"hold_length <= free_length"});
}

GripperParams row_of(std::size_t count, double flow) {
  GripperParams gripper;
  gripper.zones = {"main"};
  for (std::size_t i = 0; i < count; ++i) {
    MountedCup cup;
    cup.p_EC = Vector3(0.1 * static_cast<double>(i), 0.0, 0.0);
    gripper.cups.push_back(cup);
  }
  gripper.supply = SupplyParams{flow, -7.0e4};
  return gripper;
}

double area(double diameter) { return 0.25 * std::numbers::pi * diameter * diameter; }

TEST(Supply, OfTightCupsReachesItsDeadEnd) {
  const GripperParams gripper = row_of(4, 1e-3);
  SupplyBalance balance;
  balance_supply(gripper, std::vector(4, LineState::Sealed), balance);
  EXPECT_NEAR(balance.manifold, 7.0e4, 1e-6);
  for (const double vacuum : balance.cups) EXPECT_NEAR(vacuum, 7.0e4, 1e-6);
}

TEST(Supply, IsInBalanceWithWhatFlowsInThroughRandomCups) {
  Rng rng = Rng(5).split("supply");
  for (int k = 0; k < 500; ++k) {
    SCOPED_TRACE(k);
    GripperParams gripper = row_of(1 + static_cast<std::size_t>(rng.uniform(0.0, 20.0)), rng.uniform(1e-5, 1e-2));
    std::vector<LineState> states;
    for (MountedCup& cup : gripper.cups) {
      cup.line.port_diameter = rng.uniform(5e-4, 6e-3);
      cup.line.leak_diameter = rng.uniform(0.0, 3e-3);
      states.push_back(static_cast<LineState>(static_cast<int>(rng.uniform(0.0, 2.999))));
    }
    SupplyBalance balance;
    balance_supply(gripper, states, balance);
    double inflow = 0.0;  // each orifice by itself, through the vacuum on its side
    for (std::size_t i = 0; i < states.size(); ++i) {
      const CupLine& line = gripper.cups[i].line;
      if (states[i] == LineState::Open) inflow += area(line.port_diameter) * std::sqrt(2.0 * balance.manifold / 1.2);
      if (states[i] != LineState::Sealed) continue;
      const double through_leak = area(line.leak_diameter) * std::sqrt(2.0 * balance.cups[i] / 1.2);
      const double drop = balance.manifold - balance.cups[i];
      EXPECT_NEAR(area(line.port_diameter) * std::sqrt(2.0 * std::max(0.0, drop) / 1.2), through_leak, 1e-8);
      inflow += through_leak;
    }
    const double pumped = gripper.supply->flow * (1.0 - balance.manifold / 7.0e4);
    EXPECT_NEAR(pumped, inflow, 1e-9 + 1e-9 * pumped);
  }
}

TEST(Supply, IsWeakenedByAnOpenCupAndNotByOneWithACheckValve) {
  GripperParams gripper = row_of(4, 1e-3);
  std::vector<LineState> states(4, LineState::Sealed);
  states[3] = LineState::Open;
  SupplyBalance balance;
  balance_supply(gripper, states, balance);
  // Closed form of one orifice: q (1 - p / p0) = A sqrt(2 p / rho), with x = sqrt(p).
  const double b = area(0.004) * std::sqrt(2.0 / 1.2), a = 1e-3 / 7.0e4;
  const double x = (-b + std::sqrt(b * b + 4.0 * a * 1e-3)) / (2.0 * a);
  EXPECT_NEAR(balance.manifold, x * x, 1e-6 * x * x);
  EXPECT_LT(balance.manifold, 5.0e3);
  EXPECT_EQ(balance.cups[3], 0.0);
  gripper.cups[3].line.check_valve = true;
  balance_supply(gripper, states, balance);
  EXPECT_NEAR(balance.manifold, 7.0e4, 1e-6);
  gripper.cups[3].line.check_valve = false;
  states[3] = LineState::Shut;
  balance_supply(gripper, states, balance);
  EXPECT_NEAR(balance.manifold, 7.0e4, 1e-6);
}

TEST(EquivalentCup, OfOneCupAtEIsThatCup) {
  GripperParams gripper = row_of(1, 1e-3);
  gripper.supply.reset();
  EXPECT_EQ(equivalent_cup(gripper), gripper.cups[0].cup);
}

TEST(EquivalentCup, OfASquareOfFourIsAsStiffAsTheirElasticLawSays) {
  GripperParams gripper;
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.08, 0.08}) {
      MountedCup cup;
      cup.p_EC = Vector3(x, y, 0.0);
      gripper.cups.push_back(cup);
    }
  }
  const CupParams one, all = equivalent_cup(gripper);
  EXPECT_NEAR(all.stiffness.axial, 4.0 * one.stiffness.axial, 1e-9);
  EXPECT_NEAR(all.stiffness.bend, 4.0 * (one.stiffness.bend + one.stiffness.axial * 0.08 * 0.08), 1e-9);
  EXPECT_NEAR(all.stiffness.torsion, 4.0 * (one.stiffness.torsion + one.stiffness.lateral * (0.01 + 0.0064)), 1e-9);
  EXPECT_NEAR(all.effective_diameter, 2.0 * one.effective_diameter, 1e-12);
  EXPECT_NEAR(all.lip_radius, 0.08, 1e-12);
  EXPECT_EQ(all.hold_length, one.hold_length);
}

}  // namespace
}  // namespace snug::model
