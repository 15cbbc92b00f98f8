// GroupHalves: cuts the bodies of a group in two, with few contacts between the halves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace snug::physics::internal {

struct RowPatch;

/// Bodies by their distance, in contacts, from one at the rim of the group: those nearer than a cut are one half. What
/// lies between the halves is the seam. All of it depends on the group alone. Never allocates after construction.
class GroupHalves {
 public:
  enum Part : std::int8_t { First, Second, Seam };

  GroupHalves(std::size_t bodies, std::size_t patches);

  /// `bodies`: active bodies of the group. The cut leaves the least work to whoever sweeps the larger half, then the
  /// seam.
  void cut(std::span<const RowPatch> patches, std::span<const int> bodies);
  /// Of an active body.
  [[nodiscard]] Part of(int body) const { return level_[static_cast<std::size_t>(body)] < cut_ ? First : Second; }
  [[nodiscard]] Part of(const RowPatch& patch) const;

 private:
  void list_neighbors(std::span<const RowPatch> patches, std::span<const int> bodies);
  void find_levels(std::span<const int> bodies, int start);
  void choose_cut(std::span<const RowPatch> patches);

  std::vector<int> first_;      ///< of each active body, in neighbors_
  std::vector<int> end_;        ///< and the end of them
  std::vector<int> neighbors_;  ///< bodies
  std::vector<int> level_;      ///< of each active body: contacts between it and the start
  std::vector<int> queue_;      ///< bodies in the order in which they were reached
  std::vector<int> inside_;     ///< rows within each level
  std::vector<int> between_;    ///< rows from each level to the next
  int cut_ = 0;                 ///< first level of the second half
};

}  // namespace snug::physics::internal
