// Uncertainty: how far a scenario may be off from its cell: one block, for plants, rehearsals and repeated runs.
#pragma once

#include <numbers>

#include "snug/core/field.hpp"

namespace snug::model {

/// Half widths of uniform draws around what the scenario says. "Each" is drawn for each box (edge, pair) by itself,
/// "common" once for the whole cell.
struct Uncertainty {
  double size = 1.0e-3;                                 ///< m, each edge of each box
  double size_common = 0.003;                           ///< share, all edges of all boxes
  double mass = 0.05;                                   ///< share, each box
  double com = 5.0e-3;                                  ///< m, each coordinate of each centre of mass
  double friction = 0.20;                               ///< share, each pair's coefficient
  double contact_stiffness = 0.30;                      ///< share, common: of all pairs that give way
  double contact_travel = 0.25;                         ///< share, common: of the soft travel of all pairs
  double clearance = 0.5e-3;                            ///< m, common: of parcel_clearance
  double position = 3.0e-3;                             ///< m, each box at the aligner, along Ax and Ay
  double yaw = 1.0 * std::numbers::pi / 180.0;          ///< rad, each box at the aligner
  double aligner_position = 0.5e-3;                     ///< m, common: of the aligner, along Ax and Ay
  double aligner_yaw = 0.2 * std::numbers::pi / 180.0;  ///< rad, common
  double cup_stiffness = 0.10;                          ///< share, of the cup's stiffness, and of its damping
  double cup_length = 0.5e-3;                           ///< m, of the cup's lengths, free and holding together
  double release_push = 1.0;  ///< of cup.release_push: drawn within this of it, from none to all
  double tracking = 0.10;     ///< share, of the controller's task stiffness

  template <class Archive>
  void fields(Archive& a) {
    a("size", size, Range::NotNegative);
    a("size_common", size_common, Range::Fraction);
    a("mass", mass, Range::Fraction);
    a("com", com, Range::NotNegative);
    a("friction", friction, Range::Fraction);
    a("contact_stiffness", contact_stiffness, Range::Fraction);
    a("contact_travel", contact_travel, Range::Fraction);
    a("clearance", clearance, Range::NotNegative);
    a("position", position, Range::NotNegative);
    a("yaw_deg", Degrees{yaw}, Range::NotNegative);
    a("aligner_position", aligner_position, Range::NotNegative);
    a("aligner_yaw_deg", Degrees{aligner_yaw}, Range::NotNegative);
    a("cup_stiffness", cup_stiffness, Range::Fraction);
    a("cup_length", cup_length, Range::NotNegative);
    a("release_push", release_push, Range::Fraction);
    a("tracking", tracking, Range::Fraction);
  }
  bool operator==(const Uncertainty&) const = default;
};

/// Nothing is uncertain: what is drawn is the scenario itself.
[[nodiscard]] constexpr Uncertainty no_uncertainty() {
  return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
}

}  // namespace snug::model
