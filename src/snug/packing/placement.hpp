// Placement, Candidate: where and how an item is to stand, and why.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "snug/packing/container_state.hpp"

namespace snug::packing {

/// Where an item is to stand.
struct Placement {
  std::string item;  ///< id
  Pose X_TP;
  Orientation orientation;
  int flips = 0;  ///< from its arrival
  bool operator==(const Placement&) const = default;
};

/// Sides of a standing box, in the order of `Candidate::side_gap`.
enum class Side { LowX, HighX, LowY, HighY };

/// A place for an item, with what helps to get it there.
struct Candidate {
  Placement placement;
  double score = 0.0;             ///< the agent's; higher is better, comparable within one decision only
  double expected_percent = 0.0;  ///< final filling degree that the agent expects; 0 where it does not look ahead
  double support = 0.0;           ///< part of the lower face that rests on something, 0 .. 1
  /// m, free length beside the box at its height up to the nearest box or wall; negative where measured sizes overlap
  /// (boxes give way). Order: Side.
  std::array<double, 4> side_gap{};
  /// m, how high the nearest obstacle on each side stands above the lower face of the item (0: none within 60 mm).
  std::array<double, 4> side_height{};
  /// New places of all boxes, this one included, in an order in which they can be packed from above into the empty
  /// container; empty unless the agent re-arranges.
  std::vector<Placement> rearranged;
  bool operator==(const Candidate&) const = default;
};

/// On one side of either axis nothing is within 4 mm, more than boxes are planned to press: it is not pressed in.
[[nodiscard]] bool stands_free(const Candidate& candidate);

/// Why an item has no place.
enum class NoPlace {
  TooBig,         ///< in no allowed orientation does it fit into the empty container
  TooHeavy,       ///< heavier than the robot lifts
  NotPickable,    ///< no face that may be up is large enough for the cup
  NoSpace,        ///< nowhere left where it fits below the rim
  NoStablePlace,  ///< it would fit, but not stand
  OverLoad,       ///< it would stand, but on a box that must not carry it
  NotReachable,   ///< every place was refused by the reach function
};

/// The state as it would be if the candidate's plan came true exactly: what a plan that is not executed goes on with.
[[nodiscard]] ContainerState with_candidate(ContainerState state, const Item& item, const Candidate& candidate);

/// Whether the item would have no place in the empty container either: nothing to wait for, the next one may fit.
[[nodiscard]] bool is_infeasible(NoPlace reason);
/// "too big" and so on; a sentence's end for tables.
[[nodiscard]] std::string_view describe(NoPlace reason);

}  // namespace snug::packing
