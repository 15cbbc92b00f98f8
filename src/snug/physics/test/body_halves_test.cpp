// Body halves: what is cut, how evenly, and what lies between.
#include "snug/physics/internal/body_halves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace snug::physics::internal {
namespace {

struct Between {
  int a, b;
};

/// A block of bodies, each 1 m from its neighbours, that touch these at four points, and the floor.
struct Block {
  std::vector<Between> patches;
  std::vector<int> bodies;
  std::vector<Vector3> centres;

  Block(int nx, int ny, int nz) { add(nx, ny, nz, Vector3::Zero()); }
  void add(int nx, int ny, int nz, const Vector3& corner) {
    const int first = static_cast<int>(bodies.size());
    const auto body = [&](int x, int y, int z) { return first + (z * ny + y) * nx + x; };
    for (int z = 0; z < nz; ++z) {
      for (int y = 0; y < ny; ++y) {
        for (int x = 0; x < nx; ++x) {
          patches.push_back({z > 0 ? body(x, y, z - 1) : -1, body(x, y, z)});
          if (x > 0) patches.push_back({body(x - 1, y, z), body(x, y, z)});
          if (y > 0) patches.push_back({body(x, y - 1, z), body(x, y, z)});
          bodies.push_back(body(x, y, z));
          centres.push_back(corner + Vector3(x, y, z));
        }
      }
    }
  }
  [[nodiscard]] BodyHalves cut() const {
    BodyHalves halves(bodies.size());
    halves.begin(bodies, centres.data());
    for (const Between& patch : patches) halves.add(patch.a, patch.b, 4);
    halves.cut();
    return halves;
  }
};

/// Patches of each part.
std::array<int, 3> count_parts(const Block& block, const BodyHalves& halves) {
  std::array<int, 3> count{};
  for (const Between& patch : block.patches) ++count[static_cast<std::size_t>(halves.of(patch.a, patch.b))];
  return count;
}

TEST(BodyHalves, LeaveFewContactsBetweenThem) {
  for (const std::array<int, 3>& size : {std::array{12, 10, 6}, {10, 12, 6}, {6, 5, 40}}) {
    const Block block(size[0], size[1], size[2]);
    const auto [first, second, seam] = count_parts(block, block.cut());
    EXPECT_LT(seam, 0.05 * (first + second));
    EXPECT_GT(first, 0.45 * (first + second));
    EXPECT_GT(second, 0.45 * (first + second));
  }
}

TEST(BodyHalves, ShareNoBody) {
  const Block block(5, 7, 3);
  const BodyHalves halves = block.cut();
  for (const Between& patch : block.patches) {
    if (patch.a < 0) {
      EXPECT_EQ(halves.of(patch.a, patch.b), halves.of(patch.b));
    } else {
      EXPECT_EQ(halves.of(patch.a, patch.b) == BodyHalves::Seam, halves.of(patch.a) != halves.of(patch.b));
    }
  }
}

TEST(BodyHalves, HaveNoSeamWhereTwoHeapsStandApart) {
  Block block(4, 4, 4);
  block.add(4, 4, 4, {0.0, 9.0, 0.0});
  const auto [first, second, seam] = count_parts(block, block.cut());
  EXPECT_EQ(seam, 0);
  EXPECT_EQ(first, second);
}

/// One longer body carries all others: every cut has a seam.
TEST(BodyHalves, LeaveWhatHangsOnOneBodyToOneThread) {
  Block star(1, 1, 1);
  for (int body = 1; body < 40; ++body) {
    star.patches.push_back({0, body});
    star.bodies.push_back(body);
    star.centres.emplace_back(body, 0.0, 0.0);
  }
  const auto [first, second, seam] = count_parts(star, star.cut());
  EXPECT_EQ(std::max(first, second) + seam, 40);
}

TEST(BodyHalves, LeaveBodiesAtOnePlaceWhole) {
  Block block(3, 3, 3);
  std::fill(block.centres.begin(), block.centres.end(), Vector3(1.0, 2.0, 3.0));
  const auto [first, second, seam] = count_parts(block, block.cut());
  EXPECT_EQ(std::max(first, second), static_cast<int>(block.patches.size()));
  EXPECT_EQ(seam, 0);
}

}  // namespace
}  // namespace snug::physics::internal
