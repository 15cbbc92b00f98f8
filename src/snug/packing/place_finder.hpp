// PlaceFinder: where the next item could stand, found anew within microseconds: for those who try many placements.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "snug/core/expected.hpp"
#include "snug/packing/container_state.hpp"
#include "snug/packing/placement.hpp"
#include "snug/packing/settings.hpp"

namespace snug::packing {

/// A place for an item, without what only its execution needs (Candidate has that).
struct Place {
  Orientation orientation;
  int flips = 0;                      ///< from its arrival
  Vector3 low_T = Vector3::Zero();    ///< m, in T: corner nearest to -Tx, -Ty, -Tz
  Vector3 extents = Vector3::Zero();  ///< m, along Tx, Ty, Tz, as measured
  double support = 0.0;               ///< part of the lower face that rests on something, 0 .. 1
  bool operator==(const Place&) const = default;
};
/// X_TP of an item that stands there.
[[nodiscard]] Pose pose_at(const Place& place);

/// Keeps what stands in a container and answers where an item can be lowered. The rules are those of the agents:
/// planned_interference, min_support (0: anything that touches; load limits and balance are then not asked for either),
/// com_margin, level_slack, min_slenderness, min_pick_face, max_item_mass, max_flips. A copy is a snapshot.
class PlaceFinder {
 public:
  /// `kinds`: items that may come; spaces too narrow for all of them are forgotten. Throws InputError for settings that
  /// cannot be.
  PlaceFinder(const ContainerState& container, const PackingSettings& settings, std::span<const Item> kinds = {});
  PlaceFinder(const PlaceFinder& other);
  PlaceFinder& operator=(const PlaceFinder& other);
  PlaceFinder(PlaceFinder&&) noexcept;
  PlaceFinder& operator=(PlaceFinder&&) noexcept;
  ~PlaceFinder();

  /// Empty again, and then with these boxes and obstacles.
  void reset(const std::vector<PlacedBox>& boxes = {}, const std::vector<Extent>& obstacles = {});
  /// A box that came to stand on those before.
  void add(const PlacedBox& box);

  /// Corners into which the item can be lowered, each once: lowest first, then by x, then by y; at most `most`.
  [[nodiscard]] Expected<std::vector<Place>, NoPlace> find(const Item& item, int most);
  /// The item lowered with the middle of its lower face at (x, y) [m, in T] until it rests; what it would be, or why
  /// not.
  [[nodiscard]] Expected<Place, NoPlace> lower(const Item& item, const Orientation& orientation, double x, double y);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::packing
