// WaypointIndex: a waypoint by its place in the motion or program that it belongs to, as a type.
#pragma once

#include <compare>
#include <cstddef>

namespace snug::motion {

/// From 0.
struct WaypointIndex {
  int value = 0;
  constexpr WaypointIndex() = default;
  constexpr explicit WaypointIndex(int index) : value(index) {}
  constexpr explicit WaypointIndex(std::size_t index) : value(static_cast<int>(index)) {}
  /// Of a vector with an entry for each waypoint.
  [[nodiscard]] constexpr std::size_t slot() const { return static_cast<std::size_t>(value); }
  auto operator<=>(const WaypointIndex&) const = default;
};

}  // namespace snug::motion
