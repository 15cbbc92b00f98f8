// ItemSeconds: where the time of an item goes.
#pragma once

#include <span>

#include "snug/motion/waypoint.hpp"
#include "snug/plant/plant.hpp"

namespace snug::session {

/// s, of the plant.
struct ItemSeconds {
  double travel = 0.0;   ///< the cup empty: to the box and down to it, away from it
  double carry = 0.0;    ///< a box hangs from the cup and touches nothing
  double regrasp = 0.0;  ///< set down or turned on the bench, picked again
  double insert = 0.0;   ///< down to its place
  double push = 0.0;     ///< against neighbours (PlaceSlow), or from above
  double wait = 0.0;     ///< for the vacuum, and for tool and boxes to stand
  [[nodiscard]] double total() const { return travel + carry + regrasp + insert + push + wait; }
  ItemSeconds& operator+=(const ItemSeconds& other);
  bool operator==(const ItemSeconds&) const = default;
};

/// Of one motion, by the classes of its waypoints. `times`: at most one for each waypoint.
[[nodiscard]] ItemSeconds split_seconds(std::span<const motion::Waypoint> waypoints,
                                        std::span<const plant::WaypointTime> times);

}  // namespace snug::session
