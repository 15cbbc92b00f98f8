// SuctionCup: the cup as a force element between the gripper's end and a held package.
#pragma once

#include "snug/cup/law.hpp"
#include "snug/physics/force_element.hpp"

namespace snug::cup {

/// Spring of report eq. (3) and damper of eq. (2), between E (gripper) and S (lip, fixed to the package).
/// Frames as in model::CupParams; undeformed when S2 (fixed to E) and S1 (fixed to S) coincide.
class SuctionCup final : public physics::ForceElement {
 public:
  SuctionCup() = default;
  /// `stiffness` K and `damping` D in S1. X_PS: the lip on the package, fixed when it sealed. `law` is used in place of
  /// K where it is one that is used.
  SuctionCup(const Matrix6& stiffness, const Matrix6& damping, const Pose& X_ES2, const Pose& X_PS, const Pose& X_SS1,
             const model::CupLaw& law = {});
  /// The cup of the parameters under vacuum.
  SuctionCup(const model::CupParams& params, const Pose& X_PS);

  [[nodiscard]] physics::ElementResponse evaluate(const physics::ElementQuery& query) const noexcept override;

  /// Wrench on the package in S about the lip, spring and damper.
  [[nodiscard]] Wrench lip_wrench(const physics::ElementQuery& query) const noexcept;

  [[nodiscard]] const Pose& X_PS() const { return X_PS_; }

 private:
  struct State;
  [[nodiscard]] State state_of(const physics::ElementQuery& query) const noexcept;

  Matrix6 K_ = Matrix6::Zero();
  Matrix6 D_ = Matrix6::Zero();
  Pose X_ES2_;
  Pose X_PS_;
  Pose X_SS1_;
  model::CupLaw law_;
};

}  // namespace snug::cup
