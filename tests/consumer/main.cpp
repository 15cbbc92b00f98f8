// consumer: a box turned by a quarter about its vertical axis. Prints the angle, rad.
#include <cstdio>
#include <numbers>

#include "snug/spatial/pose.hpp"

int main() {
  snug::Pose X_WB;
  X_WB.R = snug::exp_rotation(snug::Vector3::UnitZ() * std::numbers::pi / 2);
  std::printf("%.3f\n", snug::angle_between(X_WB.R, snug::Pose{}.R));
  return 0;
}
