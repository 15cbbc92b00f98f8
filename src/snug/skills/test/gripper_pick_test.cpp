// Where a gripper of several cups takes a box: which cups seal, and how the weight is shared.
#include "snug/skills/gripper_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/cup/phases.hpp"
#include "snug/motion/tool_yaw.hpp"

namespace snug::skills {
namespace {

constexpr double kGravity = 9.81;

model::GripperParams square(double x, double y) {
  model::GripperParams gripper;
  gripper.zones = {"main"};
  for (const double sx : {1.0, -1.0}) {
    for (const double sy : {1.0, -1.0}) {
      model::MountedCup cup;
      cup.p_EC = Vector3(sx * x, sy * y, 0.0);
      gripper.cups.push_back(cup);
    }
  }
  return gripper;
}

TopFace carton(const Vector3& size, double yaw = 0.0) {
  return {Pose{exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3::Zero()}, size, 8.0, Vector3::Zero()};
}

double holds(double weight) {
  const model::CupParams cup;
  return cup::find_hold_factor(cup, cup.vacuum.pressure_gauge_hold, {Vector3(0.0, 0.0, -weight), Vector3::Zero()});
}

TEST(GripperPick, IsOverTheMiddleWithAllCupsAlongTheEdges) {
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    const double yaw = i * std::numbers::pi / 12.0;
    const auto pick = choose_gripper_pick(square(0.13, 0.08), 0.001, carton({0.6, 0.4, 0.3}, yaw), 0.3, kGravity);
    ASSERT_TRUE(pick);
    EXPECT_EQ(pick->cups.size(), 4U);
    EXPECT_LT(pick->offset_P.norm(), 1e-12);
    EXPECT_NEAR(pick->hold_factor, holds(8.0 * kGravity / 4.0), 1e-9);
    const double off = std::remainder(pick->tool_yaw - yaw, 0.5 * std::numbers::pi);
    EXPECT_NEAR(off, 0.0, 1e-9);
    EXPECT_LE(std::abs(pick->tool_yaw - 0.3), 0.25 * std::numbers::pi + 1e-9);
  }
}

TEST(GripperPick, TurnsAlongANarrowFaceWhereMoreCupsSeal) {
  // 0.2 m wide: across it only the pitch of 2 * 0.05 m fits.
  const auto pick = choose_gripper_pick(square(0.15, 0.05), 0.001, carton({0.2, 0.5, 0.2}), 0.0, kGravity);
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->cups.size(), 4U);
  EXPECT_NEAR(std::abs(std::remainder(pick->tool_yaw, std::numbers::pi)), 0.5 * std::numbers::pi, 1e-9);
}

TEST(GripperPick, UsesWhatFitsOnASmallFace) {
  const auto pick = choose_gripper_pick(square(0.13, 0.08), 0.001, carton({0.1, 0.1, 0.1}), 0.0, kGravity);
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->cups.size(), 1U);  // one cup over its middle
  EXPECT_NEAR(pick->hold_factor, holds(8.0 * kGravity), 1e-9);
  EXPECT_FALSE(choose_gripper_pick(square(0.13, 0.08), 0.001, carton({0.05, 0.05, 0.1}), 0.0, kGravity));
}

TEST(GripperPick, SharesTheWeightOfABoxBesideItsMiddle) {
  const model::GripperParams gripper = square(0.1, 0.05);
  TopFace face = carton({0.6, 0.4, 0.3});
  face.com_P = Vector3(0.04, 0.0, -0.1);
  const GripperPick pick = judge_gripper_pick(gripper, 0.0, face, 0.0, Vector3::Zero(), kGravity);
  // Two pairs at +-a; each cup bends by the same tilt.
  const model::CupParams cup;
  const double weight = 8.0 * kGravity, a = 0.1;
  const double tilt = weight * 0.04 / (4.0 * (cup.stiffness.axial * a * a + cup.stiffness.bend));
  const double load = 0.25 * weight + cup.stiffness.axial * a * tilt;
  const Wrench F_S{Vector3(0.0, 0.0, -load), Vector3(cup.stiffness.bend * tilt, 0.0, 0.0)};
  EXPECT_NEAR(pick.hold_factor, cup::find_hold_factor(cup, cup.vacuum.pressure_gauge_hold, F_S), 1e-9);
  const auto best = choose_gripper_pick(gripper, 0.0, face, 0.0, kGravity);  // over the centre of mass
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->offset_P.x(), 0.04, 1e-12);
  EXPECT_GT(best->hold_factor, pick.hold_factor);
}

TEST(GripperPick, CountsWhatOpenCupsCostTheVacuum) {
  model::GripperParams gripper = square(0.13, 0.08);
  const TopFace narrow = carton({0.6, 0.12, 0.2});
  gripper.supply = model::SupplyParams{8.3e-3, -6.0e4};
  const GripperPick open = judge_gripper_pick(gripper, 0.001, narrow, 0.0, Vector3(0.0, 0.08, 0.0), kGravity);
  EXPECT_TRUE(open.cups.empty() || open.hold_factor < holds(8.0 * kGravity / 2.0));
  for (model::MountedCup& cup : gripper.cups) cup.line.check_valve = true;
  const auto shut = choose_gripper_pick(gripper, 0.001, narrow, 0.0, kGravity);
  ASSERT_TRUE(shut);
  EXPECT_EQ(shut->cups.size(), 2U);
  EXPECT_NEAR(shut->hold_factor, holds(8.0 * kGravity / 2.0), 1e-6);
}

}  // namespace
}  // namespace snug::skills
