// measure_arm: what kinematics and inverse of the shipped arm cost.
#include "bench/figures/internal/arm_bench.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "bench/figures/internal/cpu_time.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::bench::internal {
namespace {

/// Microseconds of one call, the least of some rounds over the same inputs: what else runs on the machine adds only.
template <class Work>
double least_us(std::size_t count, Work work) {
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 30; ++round) {
    const double start = cpu_seconds();
    for (std::size_t k = 0; k < count; ++k) work(k);
    least = std::min(least, 1e6 * (cpu_seconds() - start) / static_cast<double>(count));
  }
  return least;
}

Vector3 random_vector(Rng& rng) {
  const double z = rng.normal(), y = rng.normal(), x = rng.normal();
  return {x, y, z};
}

}  // namespace

ArmCosts measure_arm_costs(const model::Scenario& scenario) {
  const robot::ArmModel arm = robot::load_arm(scenario);
  const robot::InverseKinematics inverse(arm);
  robot::ArmModel disturbed = arm;  // deviations as a calibration finds: every branch needs Newton steps
  Rng rng = Rng(1).split("arm bench");
  for (robot::Joint& joint : disturbed.joints) {
    joint.X_SJ.p += 1e-3 * random_vector(rng);
    joint.X_SJ.R = joint.X_SJ.R * exp_rotation(3e-3 * random_vector(rng));
  }
  const robot::InverseKinematics exact(disturbed);
  std::vector<robot::JointVector> q(200);
  std::vector<Pose> X_WE;
  for (robot::JointVector& values : q) {
    values.resize(arm.joint_count());
    for (double& value : values) value = rng.uniform(-3.0, 3.0);
    X_WE.push_back(robot::forward_tool(arm, values));
  }
  double sink = 0.0;
  ArmCosts costs;
  costs.forward_us = least_us(q.size(), [&](std::size_t k) { sink += robot::forward(arm, q[k]).X_WE.p.x(); });
  costs.jacobian_us =
      least_us(q.size(), [&](std::size_t k) { sink += robot::tool_jacobian(arm, robot::forward(arm, q[k]))(0, 0); });
  costs.dynamics_us = least_us(q.size(), [&](std::size_t k) {
    sink += robot::inverse_dynamics(arm, {q[k], q[k], q[k]}, Wrench{}, scenario.gravity)(0);
  });
  costs.inverse_us = least_us(q.size(), [&](std::size_t k) { sink += inverse.branches(X_WE[k], q[k]).count; });
  costs.calibrated_inverse_us = least_us(q.size(), [&](std::size_t k) { sink += exact.branches(X_WE[k], q[k]).count; });
  costs.checksum = sink;
  return costs;
}

}  // namespace snug::bench::internal
