// Loading: a container filled from a list of boxes known in advance: what fits at best, by geometry alone.
#include "snug/packing/loading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/packing/internal/blocks.hpp"

namespace snug::packing {
namespace {

using internal::BlockList;
using internal::LoadBlock;
using internal::Size3;

constexpr std::size_t kMaxBlocks = 10000;  // limit of memory
constexpr double kMinFill = 0.98;          // of a block by its boxes: as in VCS (below)
constexpr int kLongestEdge = 100000;       // the volume of a container stays below 2^63
constexpr int kMostTypes = 1000;
constexpr int kMostBoxes = 5000;  // of one type
/// Blocks looked at in one second, with all that a search does around them: measured on the reference machine.
constexpr double kBlocksPerSecond = 6.0e7;
/// Weights of a block's value, volume * usable^kLossPower * boxes^-kCountPower: the form of VCS (Araya, Guerrero and
/// Nunez, 2017) without its contact term. Of 1, 2, 4, 8 and 0, 0.1, 0.2, tried on instances 11 and 12 of BR1-BR7, these
/// load most.
constexpr double kLossPower = 8.0;
constexpr double kCountPower = 0.1;

struct Space {
  Size3 low{}, high{};
  bool operator==(const Space&) const = default;
};

bool contains(const Space& outer, const Space& inner) {
  for (std::size_t d = 0; d < 3; ++d) {
    if (inner.low[d] < outer.low[d] || inner.high[d] > outer.high[d]) return false;
  }
  return true;
}

bool overlap(const Space& a, const Space& b) {
  for (std::size_t d = 0; d < 3; ++d) {
    if (a.high[d] <= b.low[d] || b.high[d] <= a.low[d]) return false;
  }
  return true;
}

struct Placed {
  int block = 0;
  Size3 low{};
};

/// A partial load.
struct LoadNode {
  std::vector<Space> spaces;  ///< maximal, may overlap
  std::vector<int> left;      ///< boxes of each type
  std::vector<int> usable;    ///< blocks for which there are boxes left
  std::vector<Placed> placed;
  std::int64_t volume = 0;
};

class Search {
 public:
  Search(const LoadProblem& problem, const LoadSettings& settings)
      : problem_(problem), settings_(settings), list_(internal::make_blocks(problem, kMaxBlocks, kMinFill)) {
    for (std::size_t d = 0; d < 3; ++d) fill_reachable(d);
    for (const LoadBlock& block : list_.blocks) {
      count_factor_.push_back(static_cast<double>(block.volume) * std::pow(block.boxes, -kCountPower));
    }
  }

  LoadResult run() {
    const double budget = settings_.time * kBlocksPerSecond;
    LoadNode root;
    root.spaces.push_back({{0, 0, 0}, problem_.container});
    for (const CargoType& type : problem_.types) root.left.push_back(type.count);
    for (std::size_t i = 0; i < list_.blocks.size(); ++i) root.usable.push_back(static_cast<int>(i));
    best_ = root;
    for (double width = 1.0; static_cast<double>(work_) < budget; width *= std::sqrt(2.0)) {
      const int beam = static_cast<int>(std::lround(width));
      if (!search(root, beam, budget)) break;
      beam_width_ = beam;
      if (is_all_loaded() || !is_cut_) break;
    }
    return result();
  }

 private:
  struct Child {
    LoadNode node;
    LoadNode complete;
    std::int64_t work = 0;
  };

  /// Sums of box edges up to each length: space beyond the largest sum cannot be used.
  void fill_reachable(std::size_t d) {
    const auto length = static_cast<std::size_t>(problem_.container[d]);
    std::vector<char> is_sum(length + 1, 0);
    is_sum[0] = 1;
    std::vector<int> edges;
    for (const CargoType& type : problem_.types) {
      for (const Size3& size : internal::standing_sizes(type)) edges.push_back(size[d]);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (std::size_t l = 1; l <= length; ++l) {
      for (const int edge : edges) {
        if (static_cast<std::size_t>(edge) <= l && is_sum[l - static_cast<std::size_t>(edge)] != 0) is_sum[l] = 1;
      }
    }
    reachable_[d].resize(length + 1);
    for (std::size_t l = 1; l <= length; ++l) {
      reachable_[d][l] = is_sum[l] != 0 ? static_cast<int>(l) : reachable_[d][l - 1];
    }
  }

  [[nodiscard]] bool is_all_loaded() const {
    return std::all_of(best_.left.begin(), best_.left.end(), [](int left) { return left == 0; });
  }

  /// The corner of a space that is nearest to a corner of the container, by the sum of distances along the axes.
  struct Corner {
    int distance = 0;
    std::array<bool, 3> at_high{};
  };
  [[nodiscard]] Corner nearest_corner(const Space& space) const {
    Corner corner;
    for (std::size_t d = 0; d < 3; ++d) {
      const int low = space.low[d], high = problem_.container[d] - space.high[d];
      corner.at_high[d] = high < low;
      corner.distance += std::min(low, high);
    }
    return corner;
  }

  [[nodiscard]] std::size_t choose_space(const LoadNode& node) const {
    std::size_t chosen = 0;
    int best = std::numeric_limits<int>::max();
    std::int64_t best_volume = 0;
    for (std::size_t i = 0; i < node.spaces.size(); ++i) {
      const Space& space = node.spaces[i];
      const int distance = nearest_corner(space).distance;
      const std::int64_t volume =
          std::int64_t{space.high[0] - space.low[0]} * (space.high[1] - space.low[1]) * (space.high[2] - space.low[2]);
      if (distance < best || (distance == best && volume > best_volume)) {
        chosen = i;
        best = distance;
        best_volume = volume;
      }
    }
    return chosen;
  }

  /// The best `count` blocks for a space, best first. Blocks that need boxes which are gone are dropped from the list.
  std::int64_t rank_blocks(LoadNode& node, const Space& space, std::size_t count,
                           std::vector<std::pair<double, int>>& ranked) const {
    ranked.clear();
    const Size3 room{space.high[0] - space.low[0], space.high[1] - space.low[1], space.high[2] - space.low[2]};
    const double volume = static_cast<double>(room[0]) * room[1] * room[2];
    std::size_t kept = 0;
    const std::size_t total = node.usable.size();
    for (std::size_t k = 0; k < total; ++k) {
      const int index = node.usable[k];
      const auto i = static_cast<std::size_t>(index);
      if (!is_available(i, node.left)) continue;
      node.usable[kept++] = index;
      const LoadBlock& block = list_.blocks[i];
      if (block.size[0] > room[0] || block.size[1] > room[1] || block.size[2] > room[2]) continue;
      if (ranked.size() == count && count_factor_[i] <= ranked.back().first) continue;  // usable share is at most 1
      double used = 1.0;
      for (std::size_t d = 0; d < 3; ++d) {
        used *= block.size[d] + reachable_[d][static_cast<std::size_t>(room[d] - block.size[d])];
      }
      const double value = count_factor_[i] * std::pow(used / volume, kLossPower);
      if (ranked.size() == count && value <= ranked.back().first) continue;
      const auto at = std::upper_bound(ranked.begin(), ranked.end(), value,
                                       [](double v, const std::pair<double, int>& r) { return v > r.first; });
      ranked.insert(at, {value, index});
      if (ranked.size() > count) ranked.pop_back();
    }
    node.usable.resize(kept);
    return static_cast<std::int64_t>(total);
  }

  [[nodiscard]] bool is_available(std::size_t block, const std::vector<int>& left) const {
    const std::uint16_t* counts = list_.counts_of(block);
    for (std::size_t t = 0; t < left.size(); ++t) {
      if (counts[t] > left[t]) return false;
    }
    return true;
  }

  void place(LoadNode& node, std::size_t space_index, int block_index) const {
    const Space space = node.spaces[space_index];
    const LoadBlock& block = list_.blocks[static_cast<std::size_t>(block_index)];
    const Corner corner = nearest_corner(space);
    Space taken;
    for (std::size_t d = 0; d < 3; ++d) {
      taken.low[d] = corner.at_high[d] ? space.high[d] - block.size[d] : space.low[d];
      taken.high[d] = taken.low[d] + block.size[d];
    }
    node.placed.push_back({block_index, taken.low});
    node.volume += block.volume;
    for (std::size_t t = 0; t < node.left.size(); ++t) {
      node.left[t] -= list_.counts_of(static_cast<std::size_t>(block_index))[t];
    }
    cut(node.spaces, taken);
  }

  /// Free spaces after `taken` is taken out of them: again all maximal ones.
  static void cut(std::vector<Space>& spaces, const Space& taken) {
    std::vector<Space> kept, pieces;
    for (const Space& space : spaces) {
      if (!overlap(space, taken)) {
        kept.push_back(space);
        continue;
      }
      for (std::size_t d = 0; d < 3; ++d) {
        if (taken.low[d] > space.low[d]) {
          pieces.push_back(space);
          pieces.back().high[d] = taken.low[d];
        }
        if (taken.high[d] < space.high[d]) {
          pieces.push_back(space);
          pieces.back().low[d] = taken.high[d];
        }
      }
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      bool is_inside = false;
      for (const Space& space : kept) is_inside = is_inside || contains(space, pieces[i]);
      for (std::size_t j = 0; j < pieces.size() && !is_inside; ++j) {
        is_inside = j != i && contains(pieces[j], pieces[i]) && (pieces[j] != pieces[i] || j < i);
      }
      if (!is_inside) kept.push_back(pieces[i]);
    }
    spaces = std::move(kept);
  }

  std::int64_t complete(LoadNode& node) const {
    std::int64_t work = 0;
    std::vector<std::pair<double, int>> ranked;
    while (!node.spaces.empty() && !node.usable.empty()) {
      const std::size_t space = choose_space(node);
      work += rank_blocks(node, node.spaces[space], 1, ranked) + static_cast<std::int64_t>(node.spaces.size());
      if (ranked.empty()) {
        node.spaces.erase(node.spaces.begin() + static_cast<std::ptrdiff_t>(space));
      } else {
        place(node, space, ranked.front().second);
      }
    }
    return work;
  }

  /// The `width` most promising continuations of one partial load.
  void expand(LoadNode node, int width, std::vector<Child>& children) {
    std::vector<std::pair<double, int>> ranked;
    while (!node.spaces.empty() && !node.usable.empty()) {
      const std::size_t space = choose_space(node);
      work_ += rank_blocks(node, node.spaces[space], static_cast<std::size_t>(width), ranked);
      if (ranked.empty()) {
        node.spaces.erase(node.spaces.begin() + static_cast<std::ptrdiff_t>(space));
        continue;
      }
      is_cut_ = is_cut_ || ranked.size() == static_cast<std::size_t>(width);
      for (const auto& [value, block] : ranked) {
        children.push_back({node, {}, 0});
        place(children.back().node, space, block);
      }
      return;
    }
  }

  void complete_all(std::vector<Child>& children) {
    parallel_for(static_cast<int>(children.size()), settings_.threads, [&](int i, int) {
      Child& child = children[static_cast<std::size_t>(i)];
      child.complete = child.node;
      child.work = complete(child.complete);
    });
  }

  /// One beam search. False: the work was used up before its end.
  bool search(const LoadNode& root, int width, double budget) {
    is_cut_ = false;
    std::vector<LoadNode> beam{root};
    while (!beam.empty()) {
      if (static_cast<double>(work_) >= budget) return false;
      std::vector<Child> children;
      for (const LoadNode& node : beam) expand(node, width, children);
      complete_all(children);
      std::stable_sort(children.begin(), children.end(),
                       [](const Child& a, const Child& b) { return a.complete.volume > b.complete.volume; });
      beam.clear();
      is_cut_ = is_cut_ || children.size() > static_cast<std::size_t>(width);
      for (const Child& child : children) work_ += child.work;
      if (!children.empty() && children.front().complete.volume > best_.volume) best_ = children.front().complete;
      for (std::size_t i = 0; i < children.size() && beam.size() < static_cast<std::size_t>(width); ++i) {
        // The same boxes at the end from the same boxes so far: most likely the same load in another order.
        const bool is_twin = i > 0 && children[i].complete.volume == children[i - 1].complete.volume &&
                             children[i].node.left == children[i - 1].node.left;
        if (!is_twin) beam.push_back(std::move(children[i].node));
      }
    }
    return true;
  }

  [[nodiscard]] LoadResult result() const {
    LoadResult result;
    for (const Placed& placed : best_.placed) internal::list_boxes(list_, placed.block, placed.low, result.boxes);
    const double container = static_cast<double>(problem_.container[0]) * problem_.container[1] * problem_.container[2];
    result.percent = 100.0 * static_cast<double>(best_.volume) / container;
    result.work = work_;
    result.beam_width = beam_width_;
    return result;
  }

  const LoadProblem& problem_;
  LoadSettings settings_;
  BlockList list_;
  std::array<std::vector<int>, 3> reachable_;
  std::vector<double> count_factor_;
  LoadNode best_;
  std::int64_t work_ = 0;
  int beam_width_ = 0;
  bool is_cut_ = false;  ///< the last search left continuations out: a wider one may find more
};

void require(bool holds, const LoadProblem& problem, const std::string& key, const std::string& got,
             const std::string& expected) {
  if (!holds) throw InputError(problem.name, key, got, expected);
}

void check(const LoadProblem& problem, const LoadSettings& settings) {
  const auto is_length = [](int length) { return length > 0 && length <= kLongestEdge; };
  for (const int length : problem.container) {
    require(is_length(length), problem, "container", std::to_string(length), "lengths of 1 .. 100000");
  }
  require(problem.types.size() <= static_cast<std::size_t>(kMostTypes), problem, "types",
          std::to_string(problem.types.size()), "at most 1000 kinds of boxes");
  for (const CargoType& type : problem.types) {
    for (const int length : type.size) {
      require(is_length(length), problem, type.name, std::to_string(length), "edges of 1 .. 100000");
    }
    require(type.count >= 0 && type.count <= kMostBoxes, problem, type.name, std::to_string(type.count),
            "a count of 0 .. 5000");
  }
  require(std::isfinite(settings.time) && settings.time >= 0.0 && settings.time <= 86400.0, problem, "time",
          std::to_string(settings.time), "0 .. 86400 s");
  require(settings.threads >= 1 && settings.threads <= 256, problem, "threads", std::to_string(settings.threads),
          "1 .. 256");
}

}  // namespace

LoadResult load_container(const LoadProblem& problem, const LoadSettings& settings) {
  check(problem, settings);
  return Search(problem, settings).run();
}

std::vector<std::string> check_load(const LoadProblem& problem, const LoadResult& result) {
  std::vector<std::string> wrong;
  std::vector<int> counts(problem.types.size(), 0);
  for (std::size_t i = 0; i < result.boxes.size(); ++i) {
    const LoadedBox& box = result.boxes[i];
    const std::string name = "box " + std::to_string(i);
    if (box.type < 0 || static_cast<std::size_t>(box.type) >= problem.types.size()) {
      wrong.push_back(name + ": of no known type");
      continue;
    }
    const CargoType& type = problem.types[static_cast<std::size_t>(box.type)];
    if (++counts[static_cast<std::size_t>(box.type)] > type.count) wrong.push_back(name + ": more than there are");
    const std::vector<Size3> sizes = internal::standing_sizes(type);
    if (std::find(sizes.begin(), sizes.end(), box.size) == sizes.end()) wrong.push_back(name + ": must not stand so");
    const Space mine{box.low, {box.low[0] + box.size[0], box.low[1] + box.size[1], box.low[2] + box.size[2]}};
    if (!contains({{0, 0, 0}, problem.container}, mine)) wrong.push_back(name + ": outside the container");
    for (std::size_t j = 0; j < i; ++j) {
      const LoadedBox& other = result.boxes[j];
      const Space theirs{other.low,
                         {other.low[0] + other.size[0], other.low[1] + other.size[1], other.low[2] + other.size[2]}};
      if (overlap(mine, theirs)) wrong.push_back(name + ": overlaps box " + std::to_string(j));
    }
  }
  return wrong;
}

}  // namespace snug::packing
