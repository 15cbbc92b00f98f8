// ForceElement: a wrench between a driven frame and a body, with the derivatives that an implicit step needs.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::physics {

/// Where the carrier (frame E) and the body are, at one instant. World frame W throughout.
struct ElementQuery {
  Pose X_WE;                         ///< carrier
  Twist V_WE;                        ///< its twist, at E's origin, in W
  Pose X_WB;                         ///< body frame
  Twist V_WB;                        ///< body twist, linear part at the origin of B, in W
  Vector3 p_WBcm = Vector3::Zero();  ///< the body's centre of mass, m
};

/// Wrench on the body about its centre of mass, in W, and its derivatives.
struct ElementResponse {
  Vector6 wrench = Vector6::Zero();     ///< [force N; torque Nm] on the body, about p_WBcm
  Matrix6 stiffness = Matrix6::Zero();  ///< -d wrench / d x; x = [displacement of Bcm in W; small rotation in W]
  Matrix6 damping = Matrix6::Zero();    ///< -d wrench / d v; v = [velocity of Bcm in W; angular velocity in W]
  double energy = 0.0;                  ///< stored energy, J
};

/// Pure function of the query for the length of one step; must not allocate or throw.
class ForceElement {
 public:
  virtual ~ForceElement() = default;
  [[nodiscard]] virtual ElementResponse evaluate(const ElementQuery& query) const noexcept = 0;
};

}  // namespace snug::physics
