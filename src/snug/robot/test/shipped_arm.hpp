// The arm of the shipped scenario, and joints at random, for the tests of this module.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/robot/kinematics.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::robot::test {

inline const model::Scenario& demonstrator() {
  static const model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  return scenario;
}

inline const ArmModel& shipped_arm() {
  static const ArmModel arm = load_arm(demonstrator());
  return arm;
}

inline JointVector random_joints(Rng& rng, int count, double size) {
  JointVector q(count);
  for (int i = 0; i < count; ++i) q(i) = rng.uniform(-size, size);
  return q;
}

/// The arm with every joint frame moved and turned a little, as a calibration does.
inline ArmModel disturbed(ArmModel arm, Rng& rng, double metres, double radians) {
  for (Joint& joint : arm.joints) {
    joint.X_SJ.p += metres * Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    joint.X_SJ.R =
        joint.X_SJ.R * exp_rotation(radians * Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)));
  }
  return arm;
}

/// Largest difference of joints, full turns left out.
inline double turn_distance(const JointVector& a, const JointVector& b) {
  double worst = 0.0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::abs(std::remainder(a(i) - b(i), 2.0 * std::numbers::pi)));
  return worst;
}

/// Metres and radians between the tool at q and a pose.
inline double miss(const ArmModel& arm, const JointVector& q, const Pose& X_WE) {
  const Pose at = forward_tool(arm, q);
  return std::max((at.p - X_WE.p).norm(), angle_between(at.R, X_WE.R));
}

}  // namespace snug::robot::test
