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
  for (const Contact& contact : work.contacts) {
    const int a = active_of(work, contact.body_a), b = active_of(work, contact.body_b);
    if (a < 0 || b < 0) continue;
    const int root_a = find_root(work.parent, a), root_b = find_root(work.parent, b);
    if (root_a != root_b) work.parent[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }
  work.island_count = 0;
  for (Contact& contact : work.contacts) {
    const int a = active_of(work, contact.body_a);
    contact.island = island_of(work, a >= 0 ? a : active_of(work, contact.body_b));
    ++work.islands[static_cast<std::size_t>(contact.island)].end_row;  // counts first, ranges below
  }
  work.element_count = 0;
  for (std::size_t i = 0; i < input.elements.size(); ++i) {
    const int active = active_of(work, input.elements[i].body.index);
    if (active < 0) continue;
    ++work.islands[static_cast<std::size_t>(island_of(work, active))].end_element;
    ++work.element_count;
  }
  int rows = 0, elements = 0;
  for (int i = 0; i < work.island_count; ++i) {
    Island& island = work.islands[static_cast<std::size_t>(i)];
    island.first_row = rows;
    rows += island.end_row;
    island.end_row = island.first_row;  // filled below
    island.first_element = elements;
    elements += island.end_element;
    island.end_element = island.first_element;
  }
  work.sorted.resize(work.contacts.size());
  for (const Contact& contact : work.contacts) {
    work.sorted[static_cast<std::size_t>(work.islands[static_cast<std::size_t>(contact.island)].end_row++)] = contact;
  }
  for (std::size_t i = 0; i < input.elements.size(); ++i) {
    const int active = active_of(work, input.elements[i].body.index);
    if (active < 0) continue;
    Island& island = work.islands[static_cast<std::size_t>(island_of(work, active))];
    work.element_order[static_cast<std::size_t>(island.end_element++)] = static_cast<int>(i);
  }
}

}  // namespace snug::physics::internal
