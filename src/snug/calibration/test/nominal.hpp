// The shipped arm, and noise, for the tests of this module.
#pragma once

#include "snug/core/rng.hpp"
#include "snug/robot/arm.hpp"

namespace snug::calibration::test {

inline const robot::ArmModel& nominal() {
  static const robot::ArmModel arm = robot::load_urdf(SNUG_SOURCE_DIR "/scenarios/robots/ur10.urdf");
  return arm;
}

inline Vector3 normal3(Rng& rng, double size) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return size * Vector3(x, y, z);
}

}  // namespace snug::calibration::test
