// Material, ContactParams: what surfaces are made of and what happens when two of them touch.
#pragma once

#include <optional>
#include <string>

#include "snug/core/field.hpp"

namespace snug::model {

/// Index into Scenario::materials.
struct MaterialId {
  int index = 0;
  bool operator==(const MaterialId&) const = default;
};

struct Material {
  std::string name;
  std::optional<double> density;  ///< kg/m^3; needed only where a layer names the material
  bool operator==(const Material&) const = default;
};

/// Where a face that lies on another bears, and so where its friction acts.
enum class Bearing {
  Corners,  ///< on the corners of the contact patch
  Edges,    ///< evenly along the rim of the patch
  Face,     ///< with a pressure over the patch as even as equilibrium allows
};

/// Law of one contact: exact Coulomb cone, Newton restitution, and compliance where the pair is soft.
struct ContactParams {
  double friction = 0.3;            ///< Coulomb coefficient mu, >= 0
  double restitution = 0.0;         ///< Newton coefficient e_N, 0 .. 1
  std::optional<double> stiffness;  ///< N/m of one contact patch (all its points together); absent: rigid
  std::optional<double> damping;    ///< Ns/m of one contact patch; absent: 0. Only with a stiffness
  /// Soft first travel: faces bulge. Absent: `stiffness` at any depth.
  std::optional<double> travel;            ///< m, depth up to which `stiffness` holds; with stiffness_beyond
  std::optional<double> stiffness_beyond;  ///< N/m of one contact patch for each metre deeper, at least `stiffness`
  /// Edges crush: boxes whose faces overlap by less than this have stiffness and damping in proportion. Absent: no.
  std::optional<double> full_area;   ///< m^2
  std::optional<double> edge_share;  ///< share of them that edges and corners have at least, above 0; absent: 0.02
  /// What rolls or spins on a point comes to rest: moments per normal force.
  double rolling_resistance = 0.0;  ///< m, about the axes in the plane of the contact
  double torsional_friction = 0.0;  ///< m, about its normal, beside what the friction of several points does
  /// Damping over the critical one of each point by itself, beside `damping`. Absent: 0. Only with a stiffness.
  std::optional<double> damping_ratio = std::nullopt;
  /// Coulomb coefficient where one or two points bear: corners, edges, balls. Absent: `friction`.
  std::optional<double> edge_friction = std::nullopt;
  Bearing bearing = Bearing::Corners;  ///< read by itself, not one of the fields

  template <class Archive>
  void fields(Archive& a) {
    a("friction", friction, Range::NotNegative);
    a("restitution", restitution, Range::Fraction);
    a("stiffness", stiffness, Range::Positive);
    a("damping", damping, Range::NotNegative);
    a("travel", travel, Range::Positive);
    a("stiffness_beyond", stiffness_beyond, Range::Positive);
    a("full_area", full_area, Range::Positive);
    a("edge_share", edge_share, Range::Positive);
    a("rolling_resistance", rolling_resistance, Range::NotNegative);
    a("torsional_friction", torsional_friction, Range::NotNegative);
    a("damping_ratio", damping_ratio, Range::NotNegative);
    a("edge_friction", edge_friction, Range::NotNegative);
  }
  bool operator==(const ContactParams&) const = default;
};

/// One entry of the pair table; the order of a and b has no meaning.
struct ContactPair {
  MaterialId a;
  MaterialId b;
  ContactParams params;
  bool operator==(const ContactPair&) const = default;
};

}  // namespace snug::model
