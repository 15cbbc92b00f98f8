// measure_arm_costs: what kinematics and inverse of the shipped arm cost.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::bench::internal {

/// CPU time of one call, microseconds.
struct ArmCosts {
  double forward_us = 0.0;             ///< poses of all segments and the tool
  double jacobian_us = 0.0;            ///< these and the Jacobian
  double dynamics_us = 0.0;            ///< inverse dynamics
  double inverse_us = 0.0;             ///< all branches of the ideal arm
  double calibrated_inverse_us = 0.0;  ///< all branches of an arm with deviations
  double checksum = 0.0;               ///< keeps the compiler from leaving the work out
};

[[nodiscard]] ArmCosts measure_arm_costs(const model::Scenario& scenario);

}  // namespace snug::bench::internal
