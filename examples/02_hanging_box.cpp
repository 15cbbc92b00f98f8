// 02: where a box hangs that is held off its centre of mass, and what the cup feels.
#include <cstdio>
#include <numbers>

#include "snug/cup/statics.hpp"

using namespace snug;

int main() {
  cup::HeldLoad load;
  load.R_WE = exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0));  // the gripper looks down
  load.mass = 0.95;
  load.stiffness.diagonal() << 2500.0, 2500.0, 6000.0, 5.0, 5.0, 3.0;  // N/m and Nm/rad, in S1
  load.X_ES2.p = Vector3(0.0, 0.0, 0.030);
  load.X_SS1.p = Vector3(0.0, 0.0, -0.025);
  for (const double offset : {0.0, 0.02, 0.04}) {
    load.p_SScm = Vector3(offset, 0.0, 0.047);
    const cup::SettleResult rest = cup::settle(load);
    std::printf("held %2.0f mm off the centre: lip at (%.2f, %.2f, %.2f) mm, bent by %.2f degrees, %s\n", 1e3 * offset,
                1e3 * rest.X_ES.p.x(), 1e3 * rest.X_ES.p.y(), 1e3 * rest.X_ES.p.z(),
                rest.bend * 180.0 / std::numbers::pi, rest.is_stable ? "stable" : cup::name_of(rest.status));
    if (rest.status != cup::SettleStatus::Converged) return 1;
  }
  return 0;
}
