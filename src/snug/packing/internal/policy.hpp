// Policy: a quick heuristic of where a piece should go, for roll-outs and for putting candidates in a first order.
#pragma once

#include <array>
#include <vector>

#include "snug/packing/internal/layout.hpp"

namespace snug::packing::internal {

/// What is seen of a piece at a pose, each as a volume in parts of the container's (or a plain ratio).
enum Feature {
  Base,
  Top,
  Buried,
  SideWaste,
  HeightWaste,
  Contact,
  Flush,
  Support,
  Footprint,
  Sliver,
  Touch,
  Tipping,  ///< of a pallet: how easily it tips, or what it stands on with it
  Loose,    ///< of a pallet: how far film that presses it inward can push it before a neighbour backs it
  Exposed,  ///< of a pallet: area of the tops that it stands on that stays free
  kFeatureCount
};
using Features = std::array<double, kFeatureCount>;
/// Added up with these; lower is better. Found as docs/theory/packing.md says.
using Weights = std::array<double, kFeatureCount>;

/// Tuned on boxes of which few are equal.
[[nodiscard]] Weights default_weights();
/// Tuned on cubes of a grid: touch much, end level with neighbours, stand on a small side.
[[nodiscard]] Weights grid_weights();
/// Maximal contact: as much of the whole surface as can be touches boxes, floor and walls; of equals the lowest.
[[nodiscard]] Weights contact_weights();
/// Of pallets, where nothing holds a column that stands by itself, and what tips easily or is not backed against film
/// costs. Tuned on cartons of three to ten sizes.
[[nodiscard]] Weights pallet_weights();
/// For boxes of one size: layer by layer.
[[nodiscard]] Weights pallet_layer_weights();
/// Maximal contact, and of two places the lower one.
[[nodiscard]] Weights pallet_contact_weights();

/// What is left of a length when it is filled as well as sums of these lengths can: one entry a millimetre.
class WasteTable {
 public:
  WasteTable(const std::vector<int>& lengths, int longest);
  /// In ticks, for a length in ticks.
  [[nodiscard]] int waste(int length) const;

 private:
  std::vector<int> waste_;
};

struct Policy {
  Weights weights = default_weights();
  WasteTable sides;
  WasteTable heights;
};

[[nodiscard]] Features see(const Layout& layout, const Policy& policy, const Piece& piece, const CandidatePose& pose);
[[nodiscard]] double cost(const Layout& layout, const Policy& policy, const Piece& piece, const CandidatePose& pose);

}  // namespace snug::packing::internal
