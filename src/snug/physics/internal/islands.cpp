// Islands: bodies that touch each other are solved together, in an order that depends on the input alone.
#include <algorithm>
#include <numeric>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

int find_root(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    auto& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

int active_of(const Scratch& work, int body) { return work.bodies[static_cast<std::size_t>(body)].active; }

/// Island of the body's root, made when first seen.
int island_of(Scratch& work, int active) {
  const int root = find_root(work.parent, active);
  int& island = work.island_of_root[static_cast<std::size_t>(root)];
  if (island < 0) {
    island = work.island_count++;
    work.islands[static_cast<std::size_t>(island)] = Island{};
  }
  return island;
}

}  // namespace

void build_islands(const WorldInput& input, Scratch& work) {
  std::iota(work.parent.begin(), work.parent.begin() + work.active_count, 0);
  std::fill_n(work.island_of_root.begin(), work.active_count, -1);
  for (const Patch& patch : work.patches) {
    const int a = active_of(work, patch.body_a), b = active_of(work, patch.body_b);
    if (a < 0 || b < 0) continue;
    const int root_a = find_root(work.parent, a), root_b = find_root(work.parent, b);
    if (root_a != root_b) work.parent[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }
  work.island_count = 0;
  for (Patch& patch : work.patches) {
    const int a = active_of(work, patch.body_a);
    patch.island = island_of(work, a >= 0 ? a : active_of(work, patch.body_b));
    Island& island = work.islands[static_cast<std::size_t>(patch.island)];
    ++island.end_patch;  // counts first, ranges below
    island.end_row += patch.row_count;
    island.has_turning |= patch.row_count > patch.contact_count;
  }
  for (const ElementUse& use : input.elements) {
    BodyWork& body = work.bodies[static_cast<std::size_t>(use.body.index)];
    if (body.active < 0) continue;
    body.island = island_of(work, body.active);
    work.islands[static_cast<std::size_t>(body.island)].has_element = true;
  }
  int patches = 0, rows = 0;
  for (int i = 0; i < work.island_count; ++i) {
    Island& island = work.islands[static_cast<std::size_t>(i)];
    island.first_patch = patches;
    patches += island.end_patch;
    island.end_patch = island.first_patch;  // filled below
    island.first_row = rows;
    rows += island.end_row;
    island.end_row = island.first_row;  // filled below
  }
  work.row_count = rows;
  work.patch_order.resize(work.patches.size());
  for (std::size_t i = 0; i < work.patches.size(); ++i) {
    Patch& patch = work.patches[i];
    Island& island = work.islands[static_cast<std::size_t>(patch.island)];
    work.patch_order[static_cast<std::size_t>(island.end_patch++)] = static_cast<int>(i);
    patch.first_row = island.end_row;
    island.end_row += patch.row_count;
  }
}

}  // namespace snug::physics::internal
