// Tests of limits: what a run used of them, against closed forms.
#include "snug/replay/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/read_file.hpp"
#include "snug/core/units.hpp"
#include "snug/model/scenario.hpp"

namespace snug::replay {
namespace {

const std::string kScenarios = std::string(SNUG_SOURCE_DIR) + "/scenarios/";

/// Of the demonstrator's cell, whose arm is a UR10.
record::RecordingHeader ur10_header() {
  record::RecordingHeader header;
  header.scenario_text = read_file(kScenarios + "box-demonstrator.yaml", "a scenario");
  header.joints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                   "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  return header;
}

std::string ur10() { return read_file(kScenarios + "robots/ur10.urdf", "a URDF"); }

TEST(JointUseLimits, AreThoseOfTheUrdfAtTheSpeedsThatTheControllerAllows) {
  record::RecordingHeader header = ur10_header();
  const auto fast = joint_limits_of(header, ur10());
  ASSERT_TRUE(fast.has_value());
  EXPECT_NEAR(fast->speed[0], 0.97 * 120.0 * std::numbers::pi / 180.0, 1e-12);
  header.settings = R"({"controller": "lagged"})";
  const auto limits = joint_limits_of(header, ur10());
  ASSERT_TRUE(limits.has_value());
  ASSERT_EQ(limits->speed.size(), 6U);
  EXPECT_NEAR(limits->speed[0], 0.5 * 120.0 * std::numbers::pi / 180.0, 1e-12);  // 120 degrees/s
  EXPECT_NEAR(limits->speed[5], 0.5 * 180.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_EQ(limits->torque, (std::vector<double>{330.0, 330.0, 150.0, 56.0, 56.0, 56.0}));
  EXPECT_EQ(limits->acceleration, 15.0);
}

TEST(JointUseLimits, AreNotGuessed) {
  record::RecordingHeader header = ur10_header();
  EXPECT_FALSE(joint_limits_of(header, "").has_value());
  EXPECT_FALSE(joint_limits_of(header, "no XML <").has_value());
  EXPECT_FALSE(joint_limits_of(header, "<robot><joint type='revolute'><limit/></joint></robot>").has_value());
  header.joints.push_back("a joint that the URDF has not");
  EXPECT_FALSE(joint_limits_of(header, ur10()).has_value());
  header.joints.clear();
  EXPECT_FALSE(joint_limits_of(header, ur10()).has_value());
  header = ur10_header();
  header.scenario_text = "of: another version";
  EXPECT_FALSE(joint_limits_of(header, ur10()).has_value());
}

/// A hold of `pressure` that `force` (on the package, in S) loads.
record::Frame held(double pressure, const Vector3& force) {
  record::Frame frame;
  frame.cup.attached_body = 0;
  frame.cup.vacuum_command = true;
  frame.cup.pressure_gauge = pressure;
  frame.cup.F_PSo_S.force = force;
  return frame;
}

TEST(HoldUse, IsTheLoadOverWhatVacuumAndLipCarry) {
  const record::RecordingHeader header = ur10_header();
  const model::CupParams cup = model::parse_scenario(header.scenario_text, "scenario").cup;
  const double pressure = cup.vacuum.pressure_gauge_hold;
  const double suction = -pressure * std::numbers::pi / 4.0 * cup.effective_diameter * cup.effective_diameter;
  HoldUse use(header);
  EXPECT_TRUE(std::isnan(use.next(record::Frame{})));
  EXPECT_NEAR(use.next(held(pressure, {0.0, 0.0, -0.25 * suction})), 0.25, 1e-12);  // hangs
  // Shear: F <= friction * suction.
  EXPECT_NEAR(use.next(held(pressure, {0.5 * cup.lip_friction * suction, 0.0, 0.0})), 0.5, 1e-12);
  EXPECT_EQ(use.next(held(pressure, {0.0, 0.0, 10.0})), 0.0);  // pressed on
}

TEST(HoldUse, BeginsWhenTheVacuumIsEstablishedAndEndsWithTheHold) {
  const record::RecordingHeader header = ur10_header();
  const double full = model::parse_scenario(header.scenario_text, "scenario").cup.vacuum.pressure_gauge_hold;
  const Vector3 load(0.0, 0.0, -5.0);
  HoldUse use(header);
  EXPECT_TRUE(std::isnan(use.next(held(0.5 * full, load))));
  EXPECT_GT(use.next(held(0.9 * full, load)), 0.0);
  EXPECT_GT(use.next(held(0.5 * full, load)), use.next(held(0.9 * full, load)));  // still counts while it leaks
  record::Frame letting_go = held(0.9 * full, load);
  letting_go.cup.vacuum_command = false;
  EXPECT_TRUE(std::isnan(use.next(letting_go)));
  EXPECT_TRUE(std::isnan(use.next(held(0.5 * full, load))));
  EXPECT_TRUE(std::isnan(HoldUse(record::RecordingHeader{}).next(held(full, load))));
}

}  // namespace
}  // namespace snug::replay
