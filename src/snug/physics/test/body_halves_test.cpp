// Group halves: what is cut, how evenly, and what lies between.
#include "snug/physics/internal/group_halves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

/// A block of bodies that touch their neighbours at four points each, and the floor.
struct Block {
  std::vector<RowPatch> patches;
  std::vector<int> bodies;

  Block(int nx, int ny, int nz, int first_body = 0) {
    const auto body = [&](int x, int y, int z) { return first_body + (z * ny + y) * nx + x; };
    for (int z = 0; z < nz; ++z) {
      for (int y = 0; y < ny; ++y) {
        for (int x = 0; x < nx; ++x) {
          add(z > 0 ? body(x, y, z - 1) : -1, body(x, y, z));
          if (x > 0) add(body(x - 1, y, z), body(x, y, z));
          if (y > 0) add(body(x, y - 1, z), body(x, y, z));
        }
      }
    }
    bodies.resize(static_cast<std::size_t>(nx * ny * nz));
    std::iota(bodies.begin(), bodies.end(), first_body);
  }
  void add(int ia, int ib) {
    RowPatch patch;
    patch.ia = ia, patch.ib = ib, patch.count = 4;
    patches.push_back(patch);
  }
};

/// Patches of each part.
std::array<int, 3> count_parts(const Block& block, const GroupHalves& halves) {
  std::array<int, 3> count{};
  for (const RowPatch& patch : block.patches) ++count[static_cast<std::size_t>(halves.of(patch))];
  return count;
}

TEST(GroupHalves, LeaveFewContactsBetweenThem) {
  const Block block(12, 10, 6);
  GroupHalves halves(block.bodies.size(), block.patches.size());
  halves.cut(block.patches, block.bodies);
  const auto [first, second, seam] = count_parts(block, halves);
  EXPECT_LT(seam, 0.15 * (first + second));
  EXPECT_GT(first, 0.4 * (first + second));
  EXPECT_GT(second, 0.4 * (first + second));
}

TEST(GroupHalves, ShareNoBody) {
  const Block block(5, 7, 3);
  GroupHalves halves(block.bodies.size(), block.patches.size());
  halves.cut(block.patches, block.bodies);
  for (const RowPatch& patch : block.patches) {
    if (patch.ia < 0) {
      EXPECT_EQ(halves.of(patch), halves.of(patch.ib));
    } else {
      EXPECT_EQ(halves.of(patch) == GroupHalves::Seam, halves.of(patch.ia) != halves.of(patch.ib));
    }
  }
}

TEST(GroupHalves, HaveNoSeamWhereTheGroupHasTwoParts) {
  Block block(4, 4, 4);
  const Block other(4, 4, 4, 64);
  block.patches.insert(block.patches.end(), other.patches.begin(), other.patches.end());
  block.bodies.insert(block.bodies.end(), other.bodies.begin(), other.bodies.end());
  GroupHalves halves(block.bodies.size(), block.patches.size());
  halves.cut(block.patches, block.bodies);
  const auto [first, second, seam] = count_parts(block, halves);
  EXPECT_EQ(seam, 0);
  EXPECT_EQ(first, second);
}

TEST(GroupHalves, LeaveWhatHangsOnOneBodyWhole) {
  Block star(1, 1, 1);
  for (int body = 1; body < 40; ++body) star.add(0, body), star.bodies.push_back(body);
  GroupHalves halves(star.bodies.size(), star.patches.size());
  halves.cut(star.patches, star.bodies);
  const auto [first, second, seam] = count_parts(star, halves);
  EXPECT_EQ(std::max(first, second) + seam, 40);
}

}  // namespace
}  // namespace snug::physics::internal
