// SuctionCup: the holding cup as a force element: spring and damper between the gripper and a held package.
#pragma once

#include "snug/cup/law.hpp"
#include "snug/physics/force_element.hpp"

namespace snug::cup {

/// Everything the holding law needs; fixed for one step.
struct SuctionCupSetup {
  Matrix6 K = Matrix6::Zero();  ///< stiffness at S1, symmetric, positive semi-definite
  Matrix6 D = Matrix6::Zero();  ///< damping at S1, symmetric, positive semi-definite
  Pose X_ES2;                   ///< spring frame on the gripper; carries the rest length
  Pose X_PS;                    ///< lip on the package (body frame), fixed when it sealed
  Pose X_SS1;                   ///< spring frame seen from the lip
};

/// The cup at one instant.
struct CupReading {
  Pose X_S2S1;                        ///< deformation
  CupShape shape;
  Vector6 wrench_S = Vector6::Zero();  ///< spring and damper on the package, at and in S
  double energy = 0.0;                 ///< J, of the spring
  double length = 0.0;                 ///< m, of S from E along Ez
  double length_rate = 0.0;            ///< m/s
};

/// Report eq. (2). The wrench is conservative plus dissipative: the damper acts on the twist of S1 seen from the gripper
/// and only ever takes energy. Stiffness and damping matrices are exact derivatives, of the damper's wrench too.
class SuctionCup final : public physics::ForceElement {
 public:
  explicit SuctionCup(const SuctionCupSetup& setup) noexcept;

  [[nodiscard]] physics::ElementResponse evaluate(const physics::ElementQuery& query) const noexcept override;

  /// The same instant as a person or a hold limit looks at it.
  [[nodiscard]] CupReading read(const physics::ElementQuery& query) const noexcept;

  [[nodiscard]] const SuctionCupSetup& setup() const noexcept { return setup_; }

 private:
  SuctionCupSetup setup_;
  Pose X_PS1_;
};

/// The setup of a fully drawn cup: stiffness, damping and frames of the parameters, lip fixed at X_PS.
[[nodiscard]] SuctionCupSetup make_holding_setup(const model::CupParams& params, const Pose& X_PS) noexcept;

}  // namespace snug::cup
