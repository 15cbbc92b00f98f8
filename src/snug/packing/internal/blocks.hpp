// Blocks: boxes joined to larger cuboids without (much) air, the bricks that a load is built of.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "snug/packing/loading.hpp"

namespace snug::packing::internal {

using Size3 = std::array<int, 3>;

/// One box standing in one way, repeated along the axes, or two blocks side by side.
struct LoadBlock {
  Size3 size{};
  std::int64_t volume = 0;  ///< of its boxes
  int boxes = 0;
  // Grid of equal boxes: first < 0.
  int type = -1;
  Size3 box{};     ///< as it stands
  Size3 repeat{};  ///< along x, y, z
  // Two blocks along an axis.
  int first = -1, second = -1, axis = 0;
};

/// All blocks of a problem, largest volume first, and how many boxes of each type they take.
struct BlockList {
  std::vector<LoadBlock> blocks;
  std::vector<std::uint16_t> counts;  ///< blocks x types
  int types = 0;

  [[nodiscard]] const std::uint16_t* counts_of(std::size_t block) const {
    return counts.data() + block * static_cast<std::size_t>(types);
  }
};

/// Grids of equal boxes, then pairs of blocks along an axis whose boxes fill at least `min_fill` of the whole, until
/// there are `max_blocks`.
[[nodiscard]] BlockList make_blocks(const LoadProblem& problem, std::size_t max_blocks, double min_fill);

/// The boxes of a block whose low corner is at `low`.
void list_boxes(const BlockList& list, int block, const Size3& low, std::vector<LoadedBox>& out);

/// Ways in which a box may stand, without repetitions.
[[nodiscard]] std::vector<Size3> standing_sizes(const CargoType& type);

}  // namespace snug::packing::internal
