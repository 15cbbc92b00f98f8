// The arm of the shipped scenario, and joints at random, for the tests of this module.
#pragma once

#include "snug/core/rng.hpp"
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

}  // namespace snug::robot::test
