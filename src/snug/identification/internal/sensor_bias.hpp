// SensorBias: a constant that a force/torque sensor reads too much, found from poses and wrenches of a cup.
#pragma once

#include "snug/identification/internal/pose_misfit.hpp"
#include "snug/identification/stiffness.hpp"

namespace snug::identification::internal {

/// The wrenches as a sensor without this bias would have read them.
[[nodiscard]] StaticPoses without_bias(StaticPoses poses, const Wrench& bias);

/// The sensor less gravity's wrench of the known loads, where every pose has both; nothing else. It needs no law of the
/// cup. A bias is only said to be one where a constant explains what the two differ by.
[[nodiscard]] std::optional<SensorBias> compare_with_gravity(const StaticPoses& poses);

/// One step of Gauss and Newton for the bias of poses that hold it, together with the numbers of the form, from K on
/// and from no bias. `weight`: zero of poses left out. Covariance in `error` and `change`: what a unit of bias (N, Nm)
/// changes the numbers of the form by.
struct BiasStep {
  Vector6 bias, error;  ///< force N, torque Nm, in the gripper's frame about the lip
  Matrix6 covariance;
  Eigen::Matrix<double, Eigen::Dynamic, 6> change;
};
[[nodiscard]] BiasStep step_bias(const std::vector<Balance>& balances, const std::vector<double>& weight,
                                 const Matrix6& K, const NoiseAtS1& noise, const CupFrames& frames, const Form& form);

}  // namespace snug::identification::internal
