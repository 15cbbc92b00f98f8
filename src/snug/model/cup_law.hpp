// CupLaw: a cup whose stiffness depends on its compression, as wrenches measured in many poses show it.
#pragma once

#include <array>

#include "snug/core/field.hpp"

namespace snug::model {

/// A function of z, or of u: its value, first and second derivative.
struct Curve {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};
inline constexpr std::size_t kLawPowers = 6;
using Powers = std::array<Curve, kLawPowers>;

/// 1, s, s^2 .. by u; s(u) is u between -1 and 1 and ends smoothly at 1.25 and -1.25 beyond: what was measured between
/// says nothing of what is far outside.
[[nodiscard]] Powers stiffness_powers(double u);

/// Integrals over u from 0 of 1, u, u^2 .. (value), and those themselves (slope): beyond -1 and 1 they go on as
/// straight lines.
[[nodiscard]] Powers energy_powers(double u);

/// Law (f) of docs/theory/cup.md, section 8, about the centre of the cup (CupParams::centre_from_lip); used in place of
/// CupParams::stiffness where half_range is above 0. u = (z - middle) / half_range, z the growth of the cup along its
/// axis: negative where it is compressed. Polynomials of u; the axial force is zero at z = 0, so it has no constant.
struct CupLaw {
  double half_range = 0.0;                                                           ///< m
  double middle = 0.0;                                                               ///< m
  double axial_1 = 0.0, axial_2 = 0.0, axial_3 = 0.0, axial_4 = 0.0, axial_5 = 0.0;  ///< N
  double lateral_0 = 0.0, lateral_1 = 0.0, lateral_2 = 0.0;                          ///< N/m
  double bend_0 = 0.0, bend_1 = 0.0, bend_2 = 0.0;                                   ///< Nm/rad
  double coupling_0 = 0.0, coupling_1 = 0.0, coupling_2 = 0.0;                       ///< N
  double torsion_0 = 0.0, torsion_1 = 0.0;                                           ///< Nm/rad

  [[nodiscard]] bool is_used() const { return half_range > 0.0; }
  /// By z, m: the energy stored by compression alone (J, value), its force (N, slope), the axial stiffness (curvature).
  [[nodiscard]] Curve axial(double z) const;
  [[nodiscard]] Curve lateral(double z) const;
  [[nodiscard]] Curve bend(double z) const;
  [[nodiscard]] Curve coupling(double z) const;
  [[nodiscard]] Curve torsion(double z) const;
  /// Every stiffness and force times this.
  void scale(double factor);

  template <class Archive>
  void fields(Archive& a) {
    a("half_range", half_range, Range::NotNegative);
    a("middle", middle, Range::Any);
    a("axial_1", axial_1, Range::Any);
    a("axial_2", axial_2, Range::Any);
    a("axial_3", axial_3, Range::Any);
    a("axial_4", axial_4, Range::Any);
    a("axial_5", axial_5, Range::Any);
    a("lateral_0", lateral_0, Range::Positive);
    a("lateral_1", lateral_1, Range::Any);
    a("lateral_2", lateral_2, Range::Any);
    a("bend_0", bend_0, Range::Positive);
    a("bend_1", bend_1, Range::Any);
    a("bend_2", bend_2, Range::Any);
    a("coupling_0", coupling_0, Range::Any);
    a("coupling_1", coupling_1, Range::Any);
    a("coupling_2", coupling_2, Range::Any);
    a("torsion_0", torsion_0, Range::Positive);
    a("torsion_1", torsion_1, Range::Any);
  }
  bool operator==(const CupLaw&) const = default;
};

}  // namespace snug::model
