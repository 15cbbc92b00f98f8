// GroupHalves: levels by breadth-first search, the cut between two of them.
#include "snug/physics/internal/group_halves.hpp"

#include <algorithm>

#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kNone = -1;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool is_between_bodies(const RowPatch& patch) { return patch.ia >= 0 && patch.ib >= 0; }

}  // namespace

GroupHalves::GroupHalves(std::size_t bodies, std::size_t patches) : first_(bodies), end_(bodies), level_(bodies) {
  neighbors_.reserve(2 * patches);
  queue_.reserve(bodies);
  inside_.reserve(bodies);
  between_.reserve(bodies);
}

GroupHalves::Part GroupHalves::of(const RowPatch& patch) const {
  if (!is_between_bodies(patch)) return of(std::max(patch.ia, patch.ib));
  const Part a = of(patch.ia);
  return a == of(patch.ib) ? a : Seam;
}

void GroupHalves::list_neighbors(std::span<const RowPatch> patches, std::span<const int> bodies) {
  for (const int body : bodies) end_[at(body)] = 0;
  for (const RowPatch& patch : patches) {
    if (is_between_bodies(patch)) ++end_[at(patch.ia)], ++end_[at(patch.ib)];
  }
  int count = 0;
  for (const int body : bodies) {
    first_[at(body)] = count;
    count += end_[at(body)];
    end_[at(body)] = first_[at(body)];
  }
  neighbors_.resize(at(count));
  for (const RowPatch& patch : patches) {
    if (!is_between_bodies(patch)) continue;
    neighbors_[at(end_[at(patch.ia)]++)] = patch.ib;
    neighbors_[at(end_[at(patch.ib)]++)] = patch.ia;
  }
}

/// From `start` on; bodies that it does not reach come in levels behind, part by part.
void GroupHalves::find_levels(std::span<const int> bodies, int start) {
  for (const int body : bodies) level_[at(body)] = kNone;
  queue_.clear();
  std::size_t next = 0;
  const auto reach = [this](int body, int level) {
    if (level_[at(body)] != kNone) return;
    level_[at(body)] = level;
    queue_.push_back(body);
  };
  const auto reach_all_from = [&](int body) {
    reach(body, queue_.empty() ? 0 : level_[at(queue_.back())] + 1);
    for (; next < queue_.size(); ++next) {
      const int from = queue_[next];
      for (int i = first_[at(from)]; i < end_[at(from)]; ++i) reach(neighbors_[at(i)], level_[at(from)] + 1);
    }
  };
  reach_all_from(start);
  for (const int body : bodies) {
    if (level_[at(body)] == kNone) reach_all_from(body);
  }
}

void GroupHalves::choose_cut(std::span<const RowPatch> patches) {
  const auto levels = at(level_[at(queue_.back())] + 1);
  inside_.assign(levels, 0);
  between_.assign(levels, 0);
  int rest = 0;  // rows that are not in the first half
  for (const RowPatch& patch : patches) {
    const int a = level_[at(std::max(patch.ia, patch.ib))];
    const int b = is_between_bodies(patch) ? level_[at(std::min(patch.ia, patch.ib))] : a;
    (a == b ? inside_ : between_)[at(std::min(a, b))] += patch.count;
    rest += patch.count;
  }
  int first = 0, least = rest;
  cut_ = static_cast<int>(levels);
  for (std::size_t level = 0; level < levels; ++level) {
    first += inside_[level] + (level > 0 ? between_[level - 1] : 0);
    rest -= inside_[level] + (level > 0 ? between_[level - 1] : 0);
    const int seam = between_[level], longest = std::max(first, rest - seam) + seam;
    if (longest < least) least = longest, cut_ = static_cast<int>(level) + 1;
  }
}

void GroupHalves::cut(std::span<const RowPatch> patches, std::span<const int> bodies) {
  list_neighbors(patches, bodies);
  find_levels(bodies, bodies.front());
  find_levels(bodies, queue_.back());
  choose_cut(patches);
}

}  // namespace snug::physics::internal
