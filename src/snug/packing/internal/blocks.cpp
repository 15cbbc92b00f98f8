// Blocks: boxes joined to larger cuboids without (much) air, the bricks that a load is built of.
#include "snug/packing/internal/blocks.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace snug::packing::internal {
namespace {

bool fits(const Size3& size, const Size3& container) {
  return size[0] <= container[0] && size[1] <= container[1] && size[2] <= container[2];
}

std::int64_t volume_of(const Size3& size) { return std::int64_t{size[0]} * size[1] * size[2]; }

/// Collects blocks that differ in size or in what they hold.
class Builder {
 public:
  Builder(const LoadProblem& problem, std::size_t max_blocks, double min_fill)
      : problem_(problem), max_blocks_(max_blocks), min_fill_(min_fill), types_(problem.types.size()) {
    list_.types = static_cast<int>(types_);
  }

  BlockList build() {
    for (std::size_t type = 0; type < types_; ++type) add_grids(static_cast<int>(type));
    if (list_.blocks.size() > max_blocks_ / 2) keep_largest(max_blocks_ / 2);
    std::size_t old = 0;
    while (old < list_.blocks.size() && !is_full()) {
      const std::size_t end = list_.blocks.size();
      for (std::size_t i = 0; i < end && !is_full(); ++i) {
        for (std::size_t j = std::max(i + 1, old); j < end && !is_full(); ++j) add_pairs(i, j);
      }
      old = end;
    }
    return sorted();
  }

 private:
  [[nodiscard]] bool is_full() const { return list_.blocks.size() >= max_blocks_; }

  void add(const LoadBlock& block, const std::vector<std::uint16_t>& counts) {
    if (!seen_.insert({block.size, counts}).second) return;
    list_.blocks.push_back(block);
    list_.counts.insert(list_.counts.end(), counts.begin(), counts.end());
  }

  /// Of very many grids the single boxes and the largest ones.
  void keep_largest(std::size_t count) {
    std::vector<std::size_t> order(list_.blocks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const LoadBlock &x = list_.blocks[a], &y = list_.blocks[b];
      return (x.boxes == 1) != (y.boxes == 1) ? x.boxes == 1 : x.volume > y.volume;
    });
    order.resize(std::min(order.size(), count));
    BlockList kept;
    kept.types = list_.types;
    for (const std::size_t i : order) {
      kept.blocks.push_back(list_.blocks[i]);
      kept.counts.insert(kept.counts.end(), list_.counts_of(i), list_.counts_of(i) + types_);
    }
    list_ = std::move(kept);
  }

  void add_grids(int type) {
    const CargoType& cargo = problem_.types[static_cast<std::size_t>(type)];
    const std::size_t limit = list_.blocks.size() + 4 * max_blocks_;
    for (const Size3& box : standing_sizes(cargo)) {
      for (int nx = 1; nx * box[0] <= problem_.container[0] && nx <= cargo.count; ++nx) {
        for (int ny = 1; ny * box[1] <= problem_.container[1] && nx * ny <= cargo.count; ++ny) {
          for (int nz = 1; nz * box[2] <= problem_.container[2] && nx * ny * nz <= cargo.count; ++nz) {
            if (list_.blocks.size() >= limit) return;
            LoadBlock block;
            block.size = {nx * box[0], ny * box[1], nz * box[2]};
            block.volume = volume_of(block.size);
            block.boxes = nx * ny * nz;
            block.type = type;
            block.box = box;
            block.repeat = {nx, ny, nz};
            std::vector<std::uint16_t> counts(types_, 0);
            counts[static_cast<std::size_t>(type)] = static_cast<std::uint16_t>(block.boxes);
            add(block, counts);
          }
        }
      }
    }
  }

  void add_pairs(std::size_t i, std::size_t j) {
    for (std::size_t axis = 0; axis < 3 && !is_full(); ++axis) {
      const LoadBlock &a = list_.blocks[i], &b = list_.blocks[j];
      LoadBlock block;
      for (std::size_t d = 0; d < 3; ++d) {
        block.size[d] = d == axis ? a.size[d] + b.size[d] : std::max(a.size[d], b.size[d]);
      }
      if (!fits(block.size, problem_.container)) continue;
      block.volume = a.volume + b.volume;
      if (static_cast<double>(block.volume) < min_fill_ * static_cast<double>(volume_of(block.size))) continue;
      block.boxes = a.boxes + b.boxes;
      block.first = static_cast<int>(i);
      block.second = static_cast<int>(j);
      block.axis = static_cast<int>(axis);
      std::vector<std::uint16_t> counts(types_);
      for (std::size_t t = 0; t < types_; ++t) {
        const int sum = list_.counts_of(i)[t] + list_.counts_of(j)[t];
        if (sum > problem_.types[t].count) return;
        counts[t] = static_cast<std::uint16_t>(sum);
      }
      add(block, counts);
    }
  }

  BlockList sorted() const {
    std::vector<std::size_t> order(list_.blocks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return list_.blocks[a].volume > list_.blocks[b].volume; });
    std::vector<int> new_index(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) new_index[order[k]] = static_cast<int>(k);
    BlockList list;
    list.types = list_.types;
    for (const std::size_t old : order) {
      LoadBlock block = list_.blocks[old];
      if (block.first >= 0) {
        block.first = new_index[static_cast<std::size_t>(block.first)];
        block.second = new_index[static_cast<std::size_t>(block.second)];
      }
      list.blocks.push_back(block);
      list.counts.insert(list.counts.end(), list_.counts_of(old), list_.counts_of(old) + types_);
    }
    return list;
  }

  const LoadProblem& problem_;
  std::size_t max_blocks_;
  double min_fill_;
  std::size_t types_;
  BlockList list_;
  std::set<std::pair<Size3, std::vector<std::uint16_t>>> seen_;
};

}  // namespace

std::vector<Size3> standing_sizes(const CargoType& type) {
  std::vector<Size3> sizes;
  for (std::size_t up = 0; up < 3; ++up) {
    if (!type.may_be_vertical[up]) continue;
    const int a = type.size[(up + 1) % 3], b = type.size[(up + 2) % 3], z = type.size[up];
    for (const Size3& size : {Size3{a, b, z}, Size3{b, a, z}}) {
      if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(size);
    }
  }
  return sizes;
}

BlockList make_blocks(const LoadProblem& problem, std::size_t max_blocks, double min_fill) {
  return Builder(problem, max_blocks, min_fill).build();
}

void list_boxes(const BlockList& list, int block_index, const Size3& low, std::vector<LoadedBox>& out) {
  const LoadBlock& block = list.blocks[static_cast<std::size_t>(block_index)];
  if (block.first >= 0) {
    list_boxes(list, block.first, low, out);
    Size3 beside = low;
    const auto axis = static_cast<std::size_t>(block.axis);
    beside[axis] += list.blocks[static_cast<std::size_t>(block.first)].size[axis];
    list_boxes(list, block.second, beside, out);
    return;
  }
  for (int x = 0; x < block.repeat[0]; ++x) {
    for (int y = 0; y < block.repeat[1]; ++y) {
      for (int z = 0; z < block.repeat[2]; ++z) {
        out.push_back(
            {block.type, {low[0] + x * block.box[0], low[1] + y * block.box[1], low[2] + z * block.box[2]}, block.box});
      }
    }
  }
}

}  // namespace snug::packing::internal
