// What virtual experiments start from: a load at rest under the cup, and normal noise.
#pragma once

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/cup/statics.hpp"
#include "snug/identification/static_poses.hpp"

namespace snug::identification::internal {

/// Where the load hangs under a gripper of this orientation. InputError when the cup does not hold it.
[[nodiscard]] inline cup::SettleResult hang(const SpatialInertia& load_S, const Matrix3& R_WE, const Matrix6& K,
                                            const CupFrames& frames) {
  cup::HeldLoad load;
  load.R_WE = R_WE;
  load.mass = load_S.mass;
  load.p_SScm = load_S.com;
  load.stiffness = K;
  load.X_ES2 = frames.X_ES2;
  load.X_SS1 = frames.X_SS1;
  const cup::SettleResult rest = cup::settle(load);
  if (rest.status != cup::SettleStatus::Converged || !rest.is_stable)
    throw InputError("virtual experiment", "load", "one that the cup does not hold at rest",
                     "a lighter load or a stiffer cup");
  return rest;
}

[[nodiscard]] inline Vector3 normal3(Rng& rng, double deviation) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return deviation * Vector3(x, y, z);
}

}  // namespace snug::identification::internal
