// Conversions between metres in the container's frame and ticks from its corner.
#pragma once

#include <span>
#include <vector>

#include "snug/packing/agent.hpp"
#include "snug/packing/internal/layout.hpp"

namespace snug::packing::internal {

/// How an agent plans, in the units of its settings.
struct Planning {
  Vector3 inner_size = Vector3::Zero();  ///< m
  PackingSettings settings;
  int max_flips = 0;
  double margin = 0.0;                ///< m
  double planned_interference = 0.0;  ///< m
  bool has_walls = true;              ///< false: a pallet
};

[[nodiscard]] int to_ticks(double metres);
[[nodiscard]] Rules make_rules(const Planning& planning, std::span<const Item> kinds);
[[nodiscard]] Block to_block(const Planning& planning, const PlacedBox& box);
/// With the room that is kept to it.
[[nodiscard]] Block to_block(const Planning& planning, const Extent& obstacle);
/// Everything that stands in the container, in the order of the state.
[[nodiscard]] Layout to_layout(const Planning& planning, const Rules& rules, const ContainerState& state);

/// A piece that can stand with different extents; for each of them the orientations that give it.
struct Choice {
  Piece piece;
  std::vector<std::vector<Orientation>> orientations;  ///< parallel to piece.orientations
};

/// Orientations that may be planned: within the flips, allowed by the item, pickable, not too slim. The centre of mass
/// counts as the middle here: place_item looks at where it really is.
[[nodiscard]] Choice make_choice(const Planning& planning, const Item& item);
/// Why nothing can be done with an item before the state is looked at; nothing when all is well.
[[nodiscard]] std::optional<NoPlace> refuse(const Planning& planning, const Item& item, const Choice& choice);

/// The candidate of a pose: orientation with the fewest flips that balances there and can be reached; nothing when
/// none.
[[nodiscard]] Expected<Candidate, NoPlace> place_item(const Planning& planning, const Layout& layout, const Item& item,
                                                      const Choice& choice, const CandidatePose& pose,
                                                      const std::function<bool(const Placement&)>& is_reachable);

}  // namespace snug::packing::internal
