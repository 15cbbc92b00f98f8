// ContainerState: what is known about the container that is being packed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/packing/item.hpp"

namespace snug::packing {

/// A box in the container, where it was seen (or is believed to be).
struct PlacedBox {
  Item item;
  Pose X_TP;  ///< may be turned and tilted a little
  bool operator==(const PlacedBox&) const = default;
};

/// Axis-aligned extent in T, m.
struct Extent {
  Vector3 low = Vector3::Zero();
  Vector3 high = Vector3::Zero();
  bool operator==(const Extent&) const = default;
};

/// Frame T: middle of the inner floor, z up, x and y along the walls.
struct ContainerState {
  Vector3 inner_size = Vector3(0.37, 0.57, 0.25);  ///< m, along Tx, Ty, Tz
  std::vector<PlacedBox> boxes;                    ///< in the order in which they were placed
  bool has_walls = true;                           ///< false: a pallet, beside which nothing stands
  /// What is there and is none of the boxes: nothing is put where it is, under it or on it, within 12 mm beside it or
  /// within 5 mm over it.
  std::vector<Extent> obstacles = {};
  std::vector<std::string> skipped = {};  ///< ids of items that came before and are not there
  int skips_left = 0;                     ///< items without a place that may be skipped before packing ends
  bool operator==(const ContainerState&) const = default;
};

/// Empty state of a scenario's container.
[[nodiscard]] ContainerState make_container_state(const model::Container& container);

/// Smallest axis-aligned extent around a box.
[[nodiscard]] Extent bounding_extent(const PlacedBox& box);
/// The extent of the box put upright in its nearest standing orientation at the same centre.
[[nodiscard]] Extent upright_extent(const PlacedBox& box);
/// rad, from standing on a face, however it is turned about the vertical. R: of a frame whose z points up.
[[nodiscard]] double lean_of(const Matrix3& R);
/// Angle from the nearest standing orientation, rad.
[[nodiscard]] double tilt(const PlacedBox& box);

/// Percent of the inner volume filled by the boxes (measured sizes), report eq. (1).
[[nodiscard]] double filling_percent(const ContainerState& state);

}  // namespace snug::packing
