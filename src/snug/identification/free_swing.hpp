// FreeSwing: a load on a cup under a gripper at rest, integrated with the derivatives of where it goes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "snug/identification/releases.hpp"

namespace snug::identification {

/// What is simulated. All matrices in S1.
struct FreeSwing {
  SpatialInertia load_S;
  Matrix3 R_WE = Matrix3::Identity();
  CupFrames frames;
  Vector3 gravity_W{0.0, 0.0, -9.81};
  Matrix6 K = Matrix6::Identity();
  Matrix6 D = Matrix6::Zero();
};

/// Derivative of a trajectory by parameters: of K along each of `stiffness`, of D along each of `damping`, by the body
/// twist that moves the first pose, and by the first velocity.
struct SwingDirections {
  std::vector<Matrix6> damping;
  std::vector<Matrix6> stiffness;
  bool by_start = false;     ///< six columns: body twist of S1 of the first pose
  bool by_velocity = false;  ///< six columns: body twist of S1 as first velocity
  [[nodiscard]] Eigen::Index count() const;
};

struct SwingSample {
  Pose X_ES;
  Vector6 twist_S1;                                  ///< body twist of S1 relative to E
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_what;  ///< body twist of S for a unit of each direction, in this order
};

/// Poses at `times` (increasing; the first is the start), from `X_ES` moving with `twist_S1`. Fourth-order Runge-Kutta
/// with steps that resolve the fastest mode: 2e-6 of its amplitude a step (docs/theory/identification.md, section 6).
[[nodiscard]] std::vector<SwingSample> simulate_swing(const FreeSwing& swing, const Pose& X_ES, const Vector6& twist_S1,
                                                      const std::vector<double>& times,
                                                      const SwingDirections& directions = {});

}  // namespace snug::identification
