// Search: a beam of layouts, each valued by what the policy makes of the rest of the line.
#include "snug/packing/internal/search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "snug/core/hash.hpp"
#include "snug/core/parallel.hpp"

namespace snug::packing::internal {

namespace {

struct Node {
  Layout layout;
  std::vector<CandidatePose> poses;
};

/// A pose for the next piece, not yet taken.
struct Child {
  int parent = 0;
  CandidatePose pose;
  double cost_here = 0.0;
  double volume = 0.0;  ///< of the best roll-out behind it
  double mean = 0.0;
  int best_trial = 0;
};

class Beam {
 public:
  Beam(const Policy& policy, const std::vector<Piece>& pieces, const SearchSettings& settings)
      : pieces_(pieces), settings_(settings), work_(static_cast<std::size_t>(std::max(1, settings.threads))) {
    for (int trial = 0; trial < 64; ++trial) policies_.push_back(shaken(policy, settings.seed, trial));
    prospect_.kinds = pieces;
  }

  std::vector<CandidatePose> run(const Layout& start) {
    std::vector<Node> nodes{{start, {}}};
    double placed = 0.0;
    for (int index = 0; index < static_cast<int>(pieces_.size()) && !nodes.empty(); ++index) {
      placed += pieces_[static_cast<std::size_t>(index)].volume;
      std::vector<Child> children = breed(nodes, index);
      value(nodes, children, index);
      for (const Child& child : children) remember(nodes, child, index, placed);
      const int levels = static_cast<int>(pieces_.size()) - index - 1;
      nodes = select(nodes, std::move(children), index, affordable(levels));
    }
    return best_;
  }

 private:
  std::vector<Child> breed(const std::vector<Node>& nodes, int index) {
    const Piece& piece = pieces_[static_cast<std::size_t>(index)];
    std::vector<std::vector<Child>> litters(nodes.size());
    parallel_for(static_cast<int>(nodes.size()), settings_.threads, [&](int n, int thread) {
      RollOutWork& work = work_[static_cast<std::size_t>(thread)];
      const Layout& layout = nodes[static_cast<std::size_t>(n)].layout;
      work.looked_at += layout.find_poses(piece, work.list);
      std::vector<Child>& litter = litters[static_cast<std::size_t>(n)];
      for (const CandidatePose& pose : work.list.poses)
        litter.push_back({n, pose, cost(layout, policies_.front(), piece, pose)});
      std::stable_sort(litter.begin(), litter.end(),
                       [](const Child& a, const Child& b) { return a.cost_here < b.cost_here; });
      std::size_t kept = 0;
      for (const Child& child : litter) {
        if (kept >= static_cast<std::size_t>(settings_.breadth)) break;
        if (!settings_.accept || settings_.accept(layout, index, child.pose)) litter[kept++] = child;
      }
      litter.resize(kept);
    });
    std::vector<Child> children;
    for (const std::vector<Child>& litter : litters) children.insert(children.end(), litter.begin(), litter.end());
    return children;
  }

  void value(const std::vector<Node>& nodes, std::vector<Child>& children, int index) {
    Future rest(pieces_.size() - static_cast<std::size_t>(index) - 1);
    std::iota(rest.begin(), rest.end(), index + 1);
    const std::int64_t before = effort();
    parallel_for(static_cast<int>(children.size()), settings_.threads, [&](int c, int thread) {
      Child& child = children[static_cast<std::size_t>(c)];
      Layout layout = nodes[static_cast<std::size_t>(child.parent)].layout;
      layout.add(Layout::block_at(pieces_[static_cast<std::size_t>(index)], child.pose));
      child.volume = -1.0;
      for (int t = 0; t < settings_.trials; ++t) {
        const int trial = t == 0 ? 0 : 1 + (c * 7 + index * 3 + t) % 63;
        const double volume = roll_out(layout, policies_[static_cast<std::size_t>(trial)], prospect_, rest, 0,
                                       work_[static_cast<std::size_t>(thread)]);
        child.mean += volume / settings_.trials;
        if (volume <= child.volume) continue;
        child.volume = volume;
        child.best_trial = trial;
      }
    });
    if (!children.empty()) each_ = static_cast<double>(effort() - before) / static_cast<double>(children.size());
  }

  /// Keeps the longest line seen so far, with its roll-out played again to learn the poses.
  void remember(const std::vector<Node>& nodes, const Child& child, int index, double placed) {
    if (placed + child.volume <= best_volume_ + 1e-12) return;
    best_volume_ = placed + child.volume;
    const Node& parent = nodes[static_cast<std::size_t>(child.parent)];
    best_ = parent.poses;
    best_.push_back(child.pose);
    Layout layout = parent.layout;
    layout.add(Layout::block_at(pieces_[static_cast<std::size_t>(index)], child.pose));
    RollOutWork work;
    for (std::size_t i = static_cast<std::size_t>(index) + 1; i < pieces_.size(); ++i) {
      CandidatePose pose;
      if (!choose(layout, policies_[static_cast<std::size_t>(child.best_trial)], pieces_[i], work, pose)) break;
      layout.add(Layout::block_at(pieces_[i], pose));
      best_.push_back(pose);
    }
  }

  std::vector<Node> select(const std::vector<Node>& nodes, std::vector<Child> children, int index, std::size_t width) {
    std::stable_sort(children.begin(), children.end(), [](const Child& a, const Child& b) {
      return std::tuple(-a.volume, -a.mean, a.cost_here) < std::tuple(-b.volume, -b.mean, b.cost_here);
    });
    std::vector<Node> next;
    std::vector<std::vector<Block>> seen;
    for (const Child& child : children) {
      if (next.size() >= width) break;
      const Node& parent = nodes[static_cast<std::size_t>(child.parent)];
      Node node{parent.layout, parent.poses};
      node.layout.add(Layout::block_at(pieces_[static_cast<std::size_t>(index)], child.pose));
      node.poses.push_back(child.pose);
      std::vector<Block> sorted = node.layout.blocks();
      std::sort(sorted.begin(), sorted.end(), [](const Block& a, const Block& b) {
        return std::tie(a.x1, a.y1, a.z1, a.x2, a.y2, a.z2) < std::tie(b.x1, b.y1, b.z1, b.x2, b.y2, b.z2);
      });
      if (std::find(seen.begin(), seen.end(), sorted) != seen.end()) continue;
      seen.push_back(std::move(sorted));
      next.push_back(std::move(node));
    }
    return next;
  }

  [[nodiscard]] std::size_t affordable(int levels) const {
    const double rest = static_cast<double>(settings_.effort - effort()) / std::max(1, levels);
    return static_cast<std::size_t>(std::clamp(rest / (std::max(1.0, each_) * settings_.breadth), 1.0, 1000.0));
  }

  [[nodiscard]] std::int64_t effort() const {
    std::int64_t sum = 0;
    for (const RollOutWork& work : work_) sum += work.looked_at;
    return sum;
  }

  const std::vector<Piece>& pieces_;
  const SearchSettings& settings_;
  std::vector<Policy> policies_;
  Prospect prospect_;
  std::vector<RollOutWork> work_;
  std::vector<CandidatePose> best_;
  double best_volume_ = 0.0;
  double each_ = 1000.0;  ///< places that valuing one child takes
};

}  // namespace

Policy shaken(const Policy& policy, std::uint64_t seed, int number) {
  Policy result = policy;
  if (number == 0) return result;
  Rng rng = Rng(seed + 7919U * static_cast<std::uint64_t>(number)).split("opinion");
  for (double& weight : result.weights) {
    weight *= std::exp(0.4 * rng.normal());
    weight += 0.1 * rng.normal();
  }
  return result;
}

std::vector<CandidatePose> plan_in_order(const Layout& start, const Policy& policy, const std::vector<Piece>& pieces,
                                         const SearchSettings& settings) {
  if (pieces.empty()) return {};
  return Beam(policy, pieces, settings).run(start);
}

}  // namespace snug::packing::internal
