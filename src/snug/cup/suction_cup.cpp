// SuctionCup: the cup as a force element between the gripper's end and a held package.
#include "snug/cup/suction_cup.hpp"

#include "snug/cup/potential_law.hpp"

namespace snug::cup {

/// Everything that the spring and the damper need at one instant.
struct SuctionCup::State {
  Pose H;  ///< S2_H_S1
  Matrix3 R_WS1;
  Vector3 p_PcmS1;   ///< from the package's centre of mass to the origin of S1, W
  Vector3 linear;    ///< velocity of S1 relative to E, W
  Vector3 angular;   ///< angular velocity of S1 relative to E, W
  Vector6 twist_S1;  ///< both in the axes of S1
};

SuctionCup::SuctionCup(const Matrix6& stiffness, const Matrix6& damping, const Pose& X_ES2, const Pose& X_PS,
                       const Pose& X_SS1, const model::CupLaw& law)
    : K_(stiffness), D_(damping), X_ES2_(X_ES2), X_PS_(X_PS), X_SS1_(X_SS1), law_(law) {}

SuctionCup::SuctionCup(const model::CupParams& params, const Pose& X_PS)
    : SuctionCup(as_matrix(params.stiffness), as_matrix(params.damping),
                 Pose{Matrix3::Identity(), Vector3(0.0, 0.0, params.hold_length - params.centre_from_lip)}, X_PS,
                 Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -params.centre_from_lip)}, params.law) {}

SuctionCup::State SuctionCup::state_of(const physics::ElementQuery& query) const noexcept {
  State state;
  const Pose X_WS1 = query.X_WB * (X_PS_ * X_SS1_);
  state.H = (query.X_WE * X_ES2_).inverse() * X_WS1;
  state.R_WS1 = X_WS1.R;
  state.p_PcmS1 = X_WS1.p - query.p_WBcm;
  state.angular = query.V_WB.angular - query.V_WE.angular;
  state.linear = (query.V_WB.linear + query.V_WB.angular.cross(X_WS1.p - query.X_WB.p)) -
                 (query.V_WE.linear + query.V_WE.angular.cross(X_WS1.p - query.X_WE.p));
  state.twist_S1 << X_WS1.R.transpose() * state.linear, X_WS1.R.transpose() * state.angular;
  return state;
}

physics::ElementResponse SuctionCup::evaluate(const physics::ElementQuery& query) const noexcept {
  const State state = state_of(query);
  const Matrix3& R = state.R_WS1;
  const Vector3& r = state.p_PcmS1;
  Matrix6 A;  // twist of S1 in its own axes from the velocity of the centre of mass and the angular velocity in W
  A << R.transpose(), -R.transpose() * skew(r), Matrix3::Zero(), R.transpose();
  const LawResponse spring = spring_response(state.H, K_, law_);
  const Vector6 both = spring.wrench - D_ * state.twist_S1;
  physics::ElementResponse response;
  response.wrench = A.transpose() * both;
  response.energy = spring.energy;
  response.damping = A.transpose() * D_ * A;
  // Velocities in the axes of S1 change too when the package moves at constant velocities in W.
  Matrix6 T;
  T << -R.transpose() * skew(query.V_WE.angular), R.transpose() * (skew(state.linear) - skew(state.angular) * skew(r)),
      Matrix3::Zero(), R.transpose() * skew(state.angular);
  response.stiffness = A.transpose() * (D_ * T - spring.tangent * A);
  // The wrench turns with the package, and so does its arm.
  const Vector3 force_W = R * both.head<3>(), torque_W = R * both.tail<3>();
  response.stiffness.topRightCorner<3, 3>() += skew(force_W);
  response.stiffness.bottomRightCorner<3, 3>() += skew(torque_W) - skew(force_W.cross(r));
  return response;
}

Wrench SuctionCup::lip_wrench(const physics::ElementQuery& query) const noexcept {
  const State state = state_of(query);
  const Vector6 spring = spring_wrench(state.H, K_, law_);
  return wrench_from(wrench_transform(X_SS1_) * (spring - D_ * state.twist_S1));
}

}  // namespace snug::cup
