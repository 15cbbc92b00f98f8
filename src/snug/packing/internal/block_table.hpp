// BlockTable: the coordinates of blocks by column, and what is asked of all of them for every place that is looked at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace snug::packing::internal {

struct Rectangle {
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  bool operator==(const Rectangle&) const = default;
};

/// Lengths and areas in the ticks of a Layout.
class BlockTable {
 public:
  void add(const Rectangle& face, int top);

  /// Of the blocks that share some area with this one; 0 without any.
  [[nodiscard]] int highest_under(const Rectangle& area) const;
  /// What is shared with blocks whose tops are at most `slack` below `base`, and not above it.
  [[nodiscard]] std::int64_t area_held(const Rectangle& face, int base, int slack) const;

  /// Blocks at the four sides of a box: low x, high x, low y, high y.
  struct Beside {
    std::array<int, 4> gap{};  ///< to the nearest; at most what it was before
    std::int64_t contact = 0;  ///< area of side faces that are at most `touch` apart
    std::int64_t flush = 0;    ///< length of these whose tops are at most `touch` apart
  };
  /// Of blocks that reach more than `touch` above the lower face of a box that stands on `face` from `bottom` to `top`.
  void look_beside(const Rectangle& face, int bottom, int top, int touch, Beside& beside) const;

  /// Rows have these five columns one after another, each `stride_` long. Rows that are no block lie outside of
  /// everything, so that loops are over whole vectors.
  struct View {
    const int* x1;
    const int* y1;
    const int* x2;
    const int* y2;
    const int* z2;
    std::size_t count;  ///< with the rows that are no block, a multiple of kLanes
  };
  static constexpr std::size_t kLanes = 8;

 private:
  [[nodiscard]] View view() const;
  void grow();

  std::vector<int> columns_;
  std::size_t stride_ = 0;
  std::size_t count_ = 0;
};

}  // namespace snug::packing::internal
