// LipContact: an unsealed lip that presses on a face: pushes along the face's normal, rubs across it, never pulls.
#pragma once

#include "snug/physics/force_element.hpp"

namespace snug::cup {

/// Fixed for one step.
struct LipContactSetup {
  double free_length = 0.072;          ///< m, E to the lip centre along Ez when nothing touches
  double stiffness = 1500.0;           ///< N/m, along the face normal
  double damping_rate = 0.25;          ///< s/m, relative change of force per approach speed (for slow motion)
  double friction = 0.5;               ///< Coulomb coefficient
  double slip_speed = 0.005;           ///< m/s, below it friction falls off smoothly to zero
  double coverage = 1.0;               ///< 0..1, how much of the lip is over the face
  Vector3 n_P = Vector3::UnitZ();      ///< outward normal of the face, in the package frame
  Vector3 p_PFace = Vector3::Zero();   ///< a point of the face, m
};

/// Penalty force between the free lip's centre and the plane of one face.
///
/// The elastic part has a potential, starts with zero slope over the first half millimetre, is linear after that and
/// ends flat when the cup is squeezed to nothing, so it never exceeds stiffness * free_length. Damping and friction scale
/// with it, both bounded (twice and mu times the elastic force) and dissipative. All parts have exact derivatives.
class LipContact final : public physics::ForceElement {
 public:
  explicit LipContact(const LipContactSetup& setup) noexcept : setup_(setup) {}

  [[nodiscard]] physics::ElementResponse evaluate(const physics::ElementQuery& query) const noexcept override;

  /// Compression of the free lip against the face plane, m; negative when they are apart.
  [[nodiscard]] double compute_compression(const Pose& X_WE, const Pose& X_WP) const noexcept;

  [[nodiscard]] const LipContactSetup& setup() const noexcept { return setup_; }

 private:
  LipContactSetup setup_;
};

}  // namespace snug::cup
