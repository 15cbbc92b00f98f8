// Loops without branches, for vectors as wide as the processor has them. Whole numbers: every width has the same
// result.
#include "snug/packing/internal/block_table.hpp"

#include <algorithm>

#include "snug/core/wide_vectors.hpp"

namespace snug::packing::internal {
namespace {

constexpr std::size_t kColumns = 5;
constexpr int kFar = 1 << 28;  ///< ticks: beyond every container, and differences of two do not overflow

using View = BlockTable::View;
using Beside = BlockTable::Beside;

[[gnu::always_inline]] inline int smaller(int a, int b) { return a < b ? a : b; }
[[gnu::always_inline]] inline int larger(int a, int b) { return a > b ? a : b; }

[[gnu::always_inline]] inline int find_highest(const View& v, const Rectangle& area) {
  const std::size_t count = v.count & ~(BlockTable::kLanes - 1);
  int highest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int under = (v.x1[i] < area.x2) & (area.x1 < v.x2[i]) & (v.y1[i] < area.y2) & (area.y1 < v.y2[i]);
    highest = larger(highest, v.z2[i] & -under);
  }
  return highest;
}

[[gnu::always_inline]] inline std::int64_t add_held(const View& v, const Rectangle& face, int base, int slack) {
  const std::size_t count = v.count & ~(BlockTable::kLanes - 1);
  std::int64_t held = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int ox = larger(0, smaller(face.x2, v.x2[i]) - larger(face.x1, v.x1[i]));
    const int oy = larger(0, smaller(face.y2, v.y2[i]) - larger(face.y1, v.y1[i]));
    const int holds = (v.z2[i] <= base) & (base - v.z2[i] <= slack);
    held += std::int64_t{ox & -holds} * oy;
  }
  return held;
}

[[gnu::always_inline]] inline void look(const View& v, const Rectangle& face, int bottom, int top, int touch,
                                        Beside& beside) {
  const std::size_t count = v.count & ~(BlockTable::kLanes - 1);
  int low_x = beside.gap[0], high_x = beside.gap[1], low_y = beside.gap[2], high_y = beside.gap[3];
  std::int64_t contact = 0, flush = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int ox = smaller(face.x2, v.x2[i]) - larger(face.x1, v.x1[i]);
    const int oy = smaller(face.y2, v.y2[i]) - larger(face.y1, v.y1[i]);
    const int over = v.z2[i] - bottom;
    const int along_x = (ox > 0) & (oy <= 0) & (over > touch), along_y = (oy > 0) & (ox <= 0) & (over > touch);
    const int is_low_x = v.x1[i] < face.x1, is_low_y = v.y1[i] < face.y1;
    // What is no neighbour at a side is kFar away from it.
    const int gap_x = (-ox & -along_y) | (kFar & (along_y - 1)), gap_y = (-oy & -along_x) | (kFar & (along_x - 1));
    low_x = smaller(low_x, gap_x | (kFar & (is_low_x - 1)));
    high_x = smaller(high_x, gap_x | (kFar & -is_low_x));
    low_y = smaller(low_y, gap_y | (kFar & (is_low_y - 1)));
    high_y = smaller(high_y, gap_y | (kFar & -is_low_y));
    const int touches = (gap_x <= touch) | (gap_y <= touch);
    const int length = ((oy & -along_y) | (ox & -along_x)) & -touches;
    const int off = v.z2[i] - top;
    contact += std::int64_t{length} * smaller(over, top - bottom);
    flush += length & -static_cast<int>((off <= touch) & (-off <= touch));
  }
  beside.gap = {low_x, high_x, low_y, high_y};
  beside.contact += contact;
  beside.flush += flush;
}

struct Loops {
  int (*highest)(const View&, const Rectangle&);
  std::int64_t (*held)(const View&, const Rectangle&, int, int);
  void (*beside)(const View&, const Rectangle&, int, int, int, Beside&);
};

int highest_any(const View& v, const Rectangle& area) { return find_highest(v, area); }
std::int64_t held_any(const View& v, const Rectangle& face, int base, int slack) {
  return add_held(v, face, base, slack);
}
void beside_any(const View& v, const Rectangle& face, int bottom, int top, int touch, Beside& beside) {
  look(v, face, bottom, top, touch, beside);
}
#if SNUG_HAS_WIDE_VECTORS
__attribute__((target("avx2"))) int highest_by_eight(const View& v, const Rectangle& area) {
  return find_highest(v, area);
}
__attribute__((target("avx2"))) std::int64_t held_by_eight(const View& v, const Rectangle& face, int base, int slack) {
  return add_held(v, face, base, slack);
}
__attribute__((target("avx2"))) void beside_by_eight(const View& v, const Rectangle& face, int bottom, int top,
                                                     int touch, Beside& beside) {
  look(v, face, bottom, top, touch, beside);
}
#endif

Loops choose_loops() {
#if SNUG_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx2")) return {highest_by_eight, held_by_eight, beside_by_eight};
#endif
  return {highest_any, held_any, beside_any};
}

const Loops& loops() {
  static const Loops chosen = choose_loops();
  return chosen;
}

}  // namespace

void BlockTable::grow() {
  const std::size_t wider = std::max<std::size_t>(2 * kLanes, 2 * stride_);
  std::vector<int> columns(kColumns * wider, kFar);  // x1 = x2 far away: nothing is shared with such a row
  for (std::size_t column = 0; column < kColumns; ++column) {
    std::copy_n(columns_.data() + column * stride_, count_, columns.data() + column * wider);
  }
  columns_.swap(columns);
  stride_ = wider;
}

void BlockTable::add(const Rectangle& face, int top) {
  if (count_ == stride_) grow();
  const std::array<int, kColumns> row{face.x1, face.y1, face.x2, face.y2, top};
  for (std::size_t column = 0; column < kColumns; ++column) columns_[column * stride_ + count_] = row[column];
  ++count_;
}

BlockTable::View BlockTable::view() const {
  const int* const x1 = columns_.data();
  return {
      x1, x1 + stride_, x1 + 2 * stride_, x1 + 3 * stride_, x1 + 4 * stride_, (count_ + kLanes - 1) / kLanes * kLanes};
}

int BlockTable::highest_under(const Rectangle& area) const { return loops().highest(view(), area); }

std::int64_t BlockTable::area_held(const Rectangle& face, int base, int slack) const {
  return loops().held(view(), face, base, slack);
}

void BlockTable::look_beside(const Rectangle& face, int bottom, int top, int touch, Beside& beside) const {
  loops().beside(view(), face, bottom, top, touch, beside);
}

}  // namespace snug::packing::internal
