// Surroundings: gaps, heights and support against a search cell by cell in random containers.
#include "snug/skills/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "snug/core/rng.hpp"

namespace snug::skills {
namespace {

constexpr double kCell = 0.01;                        ///< m, all boxes have edges on multiples of it
constexpr int kCells[3] = {37, 57, 40};               ///< of the container; more up than its walls are high
constexpr int kWalls = 25;                            ///< cells, its height
constexpr double kHalf = 0.5 * 0.37, kHalfY = 0.285;  ///< m

struct Block {
  int low[3], size[3];
  [[nodiscard]] int top() const { return low[2] + size[2]; }
  [[nodiscard]] bool has(int x, int y) const {
    return x >= low[0] && x < low[0] + size[0] && y >= low[1] && y < low[1] + size[1];
  }
};

/// Cells up to what is highest under the block.
int support_under(const std::vector<Block>& blocks, const Block& block) {
  int top = 0;
  for (int x = block.low[0]; x < block.low[0] + block.size[0]; ++x) {
    for (int y = block.low[1]; y < block.low[1] + block.size[1]; ++y) {
      for (const Block& other : blocks) top = std::max(top, other.has(x, y) ? other.top() : 0);
    }
  }
  return top;
}

Block random_block(Rng& rng, const std::vector<Block>& blocks) {
  Block block{};
  for (int i = 0; i < 3; ++i) block.size[i] = 3 + rng.index(i == 2 ? 6 : 12);
  for (int i = 0; i < 2; ++i) block.low[i] = rng.index(kCells[i] - block.size[i] + 1);
  block.low[2] = support_under(blocks, block);
  return block;
}

Vector3 middle_of(const Block& block) {
  const auto at = [&](int i) { return kCell * (block.low[i] + 0.5 * block.size[i]); };
  return {at(0) - kHalf, at(1) - kHalfY, at(2)};
}

struct Seen {
  int gap = 0, height = 0;
};

/// What is met first from a side of the block, going outward, in any of its columns and layers.
Seen look(const std::vector<Block>& blocks, const Block& block, int axis, int step, bool has_walls) {
  const int from = step < 0 ? block.low[axis] - 1 : block.low[axis] + block.size[axis];
  for (int gap = 0; from + step * gap >= 0 && from + step * gap < kCells[axis]; ++gap) {
    int top = 0;
    for (int across = block.low[1 - axis]; across < block.low[1 - axis] + block.size[1 - axis]; ++across) {
      const int along = from + step * gap, x = axis == 0 ? along : across, y = axis == 0 ? across : along;
      for (const Block& other : blocks) {
        const bool is_beside = other.top() > block.low[2] && other.low[2] <= block.top();
        if (is_beside && other.has(x, y)) top = std::max(top, other.top());
      }
    }
    if (top > 0) return {gap, top - block.low[2]};
  }
  const int wall = step < 0 ? block.low[axis] : kCells[axis] - block.low[axis] - block.size[axis];
  return has_walls ? Seen{wall, kWalls - block.low[2]} : Seen{100, 0};
}

TEST(Measured, AgreesWithASearchCellByCell) {
  Rng rng(31);
  for (int scene = 0; scene < 200; ++scene) {
    SCOPED_TRACE(scene);
    packing::ContainerState state;
    state.has_walls = scene % 2 == 0;
    std::vector<Block> blocks;
    for (int i = rng.index(12); i > 0; --i) {
      const Block block = random_block(rng, blocks);
      blocks.push_back(block);
      packing::PlacedBox placed;
      placed.X_TP.p = middle_of(block);
      // Turned by quarters: it is the extent along the container's axes that counts.
      placed.X_TP.R = exp_rotation(Vector3(0.0, 0.0, 0.5 * std::numbers::pi * rng.index(4)));
      placed.item.size =
          (placed.X_TP.R.transpose() * Vector3(block.size[0], block.size[1], block.size[2])).cwiseAbs() * kCell;
      state.boxes.push_back(placed);
    }
    const Block block = random_block(rng, blocks);
    packing::Candidate candidate;
    // Half a cell higher than the block, so that nothing begins where it ends; given a little too high.
    const Vector3 size(kCell * block.size[0], kCell * block.size[1], kCell * (block.size[2] + 0.5));
    candidate.placement.X_TP.p = middle_of(block) + Vector3(0.0, 0.0, 0.005);
    const packing::Candidate seen = measured(state, candidate, size, 0.0);
    EXPECT_NEAR(seen.placement.X_TP.p.z(), kCell * block.low[2] + 0.5 * size.z(), 1e-12);
    for (std::size_t side = 0; side < 4; ++side) {
      SCOPED_TRACE(side);
      const Seen expected = look(blocks, block, static_cast<int>(side / 2), side % 2 == 0 ? -1 : 1, state.has_walls);
      EXPECT_NEAR(seen.side_gap[side], kCell * expected.gap, 1e-9);
      EXPECT_NEAR(seen.side_height[side], kCell * expected.height, 1e-9);
    }
    EXPECT_EQ(seen.placement.X_TP.p.head<2>(), candidate.placement.X_TP.p.head<2>());
    // Measured once more nothing changes.
    EXPECT_EQ(measured(state, seen, size, 0.0), seen);
  }
}

packing::PlacedBox box_at(const Vector3& size, const Vector3& p_TP) {
  packing::PlacedBox box;
  box.item.size = size;
  box.X_TP.p = p_TP;
  return box;
}

TEST(Measured, ShrinksBoxesOnBothSidesOfAGapAndLeavesWallsAsTheyAre) {
  packing::ContainerState state;
  const Vector3 size = Vector3::Constant(0.1);
  state.boxes = {box_at(size, Vector3(-0.12, 0.0, 0.05)), box_at(size, Vector3(0.0, 0.0, 0.05))};
  packing::Candidate candidate;
  candidate.placement.X_TP.p = Vector3(-0.01, 0.0, 0.16);  // on both
  const auto seen = measured(state, candidate, size, 0.004);
  EXPECT_NEAR(seen.placement.X_TP.p.z(), 0.098 + 0.048, 1e-12);
  candidate.placement.X_TP.p = Vector3(0.11, 0.0, 0.06);
  const auto beside = measured(state, candidate, size, 0.004);
  EXPECT_NEAR(beside.side_gap[0], 0.01 + 0.004, 1e-12);
  EXPECT_NEAR(beside.side_gap[1], 0.185 - 0.16 + 0.002, 1e-12);
}

TEST(Measured, LeavesOutWhatItMerelyGrazes) {
  const settings::InsertionParams params;
  const Vector3 size = Vector3::Constant(0.1);
  for (const double overlap : {params.graze - 1e-6, params.graze + 1e-6}) {
    const bool counts = overlap > params.graze;
    packing::Candidate candidate;
    candidate.placement.X_TP.p.z() = 0.16;
    packing::ContainerState state;
    state.boxes = {box_at(size, Vector3(0.1 - overlap, 0.0, 0.05))};
    EXPECT_NEAR(measured(state, candidate, size, 0.0).placement.X_TP.p.z(), counts ? 0.15 : 0.05, 1e-12);
    candidate.placement.X_TP.p.z() = 0.05;
    state.boxes = {box_at(size, Vector3(0.12, 0.1 - overlap, 0.05))};
    EXPECT_NEAR(measured(state, candidate, size, 0.0).side_gap[1], counts ? 0.02 : 0.135, 1e-12);
  }
  // A neighbour is believed a little inside the box; one far inside is none.
  for (const double depth : {params.inside - 1e-6, params.inside + 1e-6}) {
    packing::ContainerState state;
    packing::Candidate candidate;
    candidate.placement.X_TP.p.z() = 0.05;
    state.boxes = {box_at(size, Vector3(0.1 - depth, 0.0, 0.05))};
    EXPECT_NEAR(measured(state, candidate, size, 0.0).side_gap[1], depth < params.inside ? -depth : 0.135, 1e-12);
  }
}

}  // namespace
}  // namespace snug::skills
