// Item, Orientation: a box to be packed, and the ways in which it can stand.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/model/parcel.hpp"
#include "snug/model/scenario.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::packing {

/// How a box stands with its edges along those of the container (or of the aligner).
struct Orientation {
  model::UpAxis up = model::UpAxis::Z;  ///< the axis of P that is vertical
  int up_sign = 1;                      ///< +1 or -1: which end of that axis is up
  int yaw_quarter = 0;                  ///< quarter turns about the vertical, 0 .. 3
  bool operator==(const Orientation&) const = default;
};

/// One box to be packed. Frame P: geometric centre, axes along the edges.
struct Item {
  std::string id;
  std::string type;
  Vector3 size = Vector3::Constant(0.1);  ///< m, along Px, Py, Pz, as measured
  double mass = 1.0;                      ///< kg
  Vector3 com = Vector3::Zero();          ///< p_PPcm, m
  Orientation arrival;                    ///< how it stands at the pick location; its yaw is that of R_AP
  bool upright_only = false;              ///< only with +Pz up
  bool no_stack = false;                  ///< nothing may stand on it
  std::optional<double> max_load;         ///< kg that may rest on it; absent: any
  bool operator==(const Item&) const = default;
};

/// R_TP (or R_AP) of a box that stands so.
[[nodiscard]] Matrix3 rotation(const Orientation& orientation);
/// Lengths along Tx, Ty, Tz of a box of this size that stands so, m.
[[nodiscard]] Vector3 extents(const Orientation& orientation, const Vector3& size);
/// The standing orientation nearest to a rotation.
[[nodiscard]] Orientation nearest_orientation(const Matrix3& R_TP);
/// Quarter turns over an edge that lead from one to the other: 0 (same end up), 1 (another axis up), 2 (upside down).
[[nodiscard]] int count_flips(const Orientation& from, const Orientation& to);
/// All that this item may stand in, in a fixed order: at most `max_flips` from its arrival; upright-only items only
/// with +Pz up. With `all_yaws` false the yaws 2, 3, which occupy the same space as 0, 1, are left out.
[[nodiscard]] std::vector<Orientation> allowed_orientations(const Item& item, int max_flips, bool all_yaws = false);

/// The item that a scenario's sequence names. Throws InputError for an unknown parcel.
[[nodiscard]] Item make_item(const model::Scenario& scenario, const model::Item& item);
/// The items of a sequence in the order in which they come.
[[nodiscard]] std::vector<Item> make_items(const model::Scenario& scenario, const model::Sequence& sequence);

}  // namespace snug::packing
