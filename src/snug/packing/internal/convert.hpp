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
/// The same for rows of boxes that have no millimetre to spare: boxes have the length and width that their kind has,
/// and an edge within 3 mm of one that was there before, or of the rim, lies on it.
[[nodiscard]] Layout to_aligned_layout(const Planning& planning, const Rules& rules, const ContainerState& state,
                                       std::span<const Item> kinds);
/// With the size of the first kind of its type that it was measured within 3 mm of, if there is one.
[[nodiscard]] Item with_size_of_kind(Item item, std::span<const Item> kinds);

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
/// Moves a candidate that was found in an aligned layout, lowered to `base`, to where the item as it was measured is
/// clear of what stands beside it; into the middle where there is too little room, but not over the rim. False: it
/// would be more than 3 mm in the way.
[[nodiscard]] bool make_clear(const Planning& planning, const Layout& layout, const Item& item, int base,
                              Candidate& candidate);

}  // namespace snug::packing::internal
