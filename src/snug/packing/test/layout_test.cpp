// Layout: lowering and corners against a height map in cells and against trying every cell.
#include "snug/packing/internal/layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/internal/agents.hpp"
#include "snug/packing/internal/policy.hpp"
#include "snug/packing/test/scene.hpp"

namespace snug::packing::internal {
namespace {

using packing::test::kCell;

Rules small_rules(double min_support) {
  Rules rules;
  rules.size_x = 12 * kCell;
  rules.size_y = 9 * kCell;
  rules.size_z = 8 * kCell;
  rules.min_support = min_support;
  rules.com_margin = 0;
  return rules;
}

Piece random_piece(Rng& rng) {
  Piece piece;
  piece.orientations.push_back(
      {(1 + rng.index(5)) * kCell, (1 + rng.index(5)) * kCell, (1 + rng.index(4)) * kCell, 0, 0, 0});
  return piece;
}

/// What BlockTable answers, block by block, written from what its header says.
struct PlainTable {
  std::vector<Block> blocks;

  static int shared(int low, int high, int other_low, int other_high) {
    return std::min(high, other_high) - std::max(low, other_low);
  }
  [[nodiscard]] int highest_under(const Rectangle& area) const {
    int highest = 0;
    for (const Block& b : blocks) {
      if (shared(area.x1, area.x2, b.x1, b.x2) > 0 && shared(area.y1, area.y2, b.y1, b.y2) > 0)
        highest = std::max(highest, b.z2);
    }
    return highest;
  }
  [[nodiscard]] std::int64_t area_held(const Rectangle& face, int base, int slack) const {
    std::int64_t held = 0;
    for (const Block& b : blocks) {
      const int x = shared(face.x1, face.x2, b.x1, b.x2), y = shared(face.y1, face.y2, b.y1, b.y2);
      if (x > 0 && y > 0 && b.z2 <= base && b.z2 >= base - slack) held += std::int64_t{x} * y;
    }
    return held;
  }
  void look_beside(const Rectangle& face, int bottom, int top, int touch, BlockTable::Beside& beside) const {
    for (const Block& b : blocks) {
      const int x = shared(face.x1, face.x2, b.x1, b.x2), y = shared(face.y1, face.y2, b.y1, b.y2);
      if ((x > 0) == (y > 0) || b.z2 - bottom <= touch) continue;
      const std::size_t side = y > 0 ? (b.x1 < face.x1 ? 0U : 1U) : (b.y1 < face.y1 ? 2U : 3U);
      const int gap = y > 0 ? -x : -y, along = y > 0 ? y : x;
      beside.gap[side] = std::min(beside.gap[side], gap);
      if (gap > touch) continue;
      beside.contact += std::int64_t{along} * std::min(b.z2 - bottom, top - bottom);
      if (std::abs(b.z2 - top) <= touch) beside.flush += along;
    }
  }
};

TEST(BlockTable, AnswersAsBlocksDoOneByOne) {
  Rng rng = Rng(4).split("table");
  const auto interval = [&rng](int longest) {
    const int low = rng.index(120), length = 1 + rng.index(longest);
    return std::pair(low, low + length);
  };
  for (int count = 0; count <= 40; ++count) {  // past several vectors, and every rest of one
    BlockTable table;
    PlainTable plain;
    for (int i = 0; i < count; ++i) {
      const auto [x1, x2] = interval(50);
      const auto [y1, y2] = interval(50);
      const int top = 1 + rng.index(60);
      table.add({x1, y1, x2, y2}, top);
      plain.blocks.push_back({x1, y1, 0, x2, y2, top});
    }
    for (int i = 0; i < 200; ++i) {
      SCOPED_TRACE(count * 1000 + i);
      const auto [x1, x2] = interval(60);
      const auto [y1, y2] = interval(60);
      const auto [bottom, top] = interval(40);
      const Rectangle face{x1, y1, x2, y2};
      const int touch = rng.index(5);
      EXPECT_EQ(table.highest_under(face), plain.highest_under(face));
      EXPECT_EQ(table.area_held(face, bottom, touch), plain.area_held(face, bottom, touch));
      BlockTable::Beside is{{90, 80, 70, 60}, 5, 3}, should{{90, 80, 70, 60}, 5, 3};
      table.look_beside(face, bottom, top, touch, is);
      plain.look_beside(face, bottom, top, touch, should);
      EXPECT_EQ(is.gap, should.gap);
      EXPECT_EQ(is.contact, should.contact);
      EXPECT_EQ(is.flush, should.flush);
    }
  }
}

/// Some pieces lowered at random cells.
Layout random_layout(double min_support, int count, Rng& rng) {
  Layout layout(small_rules(min_support));
  for (int i = 0; i < count; ++i) {
    const Piece piece = random_piece(rng);
    CandidatePose pose;
    if (layout.settle(piece, 0, rng.index(12) * kCell, rng.index(9) * kCell, pose) != Refusal::None) continue;
    layout.add(Layout::block_at(piece, pose));
  }
  return layout;
}

int top_of_cell(const Layout& layout, int cx, int cy) {
  int top = 0;
  for (const Block& b : layout.blocks()) {
    const bool covers = b.x1 <= cx * kCell && cx * kCell < b.x2 && b.y1 <= cy * kCell && cy * kCell < b.y2;
    if (covers) top = std::max(top, b.z2);
  }
  return top;
}

TEST(Layout, CarriesABoxOfAnyAreaThatAContainerCanHave) {
  // 10 m x 10 m is 10^10 squares of a tenth of a millimetre.
  Rules rules;
  rules.size_x = rules.size_y = 100000;
  rules.size_z = 20000;
  for (const int side : {46000, 46400, 65600, 100000}) {  // 46 341 squared is 2^31
    SCOPED_TRACE(side);
    Layout layout(rules);
    layout.add({0, 0, 0, side, side, 1000, 1000});
    Piece piece;
    piece.orientations.push_back({side, side, 1000, 0, 0, 0});
    CandidatePose pose;
    EXPECT_EQ(layout.settle(piece, 0, 0, 0, pose), Refusal::None);
    EXPECT_EQ(pose.z, 1000);
    EXPECT_EQ(pose.support, 1.0);
    layout.add(Layout::block_at(piece, pose));
    EXPECT_NEAR(layout.columns().back(), 1000.0, 1e-9);
  }
}

TEST(Layout, LowersAsAHeightMapDoes) {
  Rng rng = Rng(3).split("height map");
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Layout layout = random_layout(0.0, 8, rng);
    const Piece piece = random_piece(rng);
    const int x = rng.index(12), y = rng.index(9);
    const PieceOrientation& s = piece.orientations.front();
    CandidatePose pose;
    const Refusal refusal = layout.settle(piece, 0, x * kCell, y * kCell, pose);
    if (x * kCell + s.width > 12 * kCell || y * kCell + s.depth > 9 * kCell) {
      EXPECT_EQ(refusal, Refusal::Outside);
      continue;
    }
    int base = 0, cells = 0, held = 0;
    for (int pass = 0; pass < 2; ++pass) {
      for (int cx = x; cx < x + s.width / kCell; ++cx) {
        for (int cy = y; cy < y + s.depth / kCell; ++cy) {
          const int top = top_of_cell(layout, cx, cy);
          if (pass == 0) base = std::max(base, top);
          cells += pass;
          held += pass == 1 && top == base ? 1 : 0;
        }
      }
    }
    if (base + s.height > 8 * kCell) {
      EXPECT_EQ(refusal, Refusal::Height);
      continue;
    }
    EXPECT_EQ(pose.z, base);
    EXPECT_DOUBLE_EQ(pose.support, static_cast<double>(held) / cells);
  }
}

TEST(Layout, FindsACornerWheneverAnyCellWouldDo) {
  Rng rng = Rng(5).split("corners");
  int full = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const Layout layout = random_layout(0.0, 30, rng);
    const Piece piece = random_piece(rng);
    bool fits = false;
    CandidatePose pose;
    for (int x = 0; x < 12 && !fits; ++x) {
      for (int y = 0; y < 9 && !fits; ++y) fits = layout.settle(piece, 0, x * kCell, y * kCell, pose) == Refusal::None;
    }
    CandidatePoseList list;
    (void)layout.find_poses(piece, list);
    EXPECT_EQ(list.poses.empty(), !fits);
    full += fits ? 0 : 1;
  }
  EXPECT_GT(full, 20);  // both answers have to occur for the test to mean anything
}

TEST(Layout, MirroredContainerHasMirroredCorners) {
  Rng rng = Rng(6).split("mirror");
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const Layout layout = random_layout(0.6, 10, rng);
    const Piece piece = random_piece(rng);
    Layout mirrored(layout.rules());
    for (Block b : layout.blocks()) {
      std::tie(b.x1, b.x2) = std::pair(layout.rules().size_x - b.x2, layout.rules().size_x - b.x1);
      mirrored.add(b);
    }
    CandidatePoseList here, there;
    (void)layout.find_poses(piece, here);
    (void)mirrored.find_poses(piece, there);
    using Key = std::tuple<int, int, int>;
    std::set<Key> expected, found;
    const int width = piece.orientations.front().width;
    for (const CandidatePose& s : here.poses) expected.insert({layout.rules().size_x - s.x - width, s.y, s.z});
    for (const CandidatePose& s : there.poses) found.insert({s.x, s.y, s.z});
    EXPECT_EQ(found, expected);
  }
}

TEST(Layout, KeepsTheMarginToWallsAndBoxes) {
  Rules rules = small_rules(0.6);
  rules.margin = kCell;
  Layout layout(rules);
  layout.add({kCell, kCell, 0, 4 * kCell, 4 * kCell, 4 * kCell});
  Piece piece;
  piece.orientations.push_back({2 * kCell, 2 * kCell, 3 * kCell, 0, 0, 0});
  CandidatePoseList list;
  (void)layout.find_poses(piece, list);
  ASSERT_FALSE(list.poses.empty());
  for (const CandidatePose& s : list.poses) {
    EXPECT_GE(s.x, kCell);
    EXPECT_LE(s.x + 2 * kCell, 11 * kCell);
    EXPECT_TRUE(s.z == 4 * kCell || s.x >= 5 * kCell || s.y >= 5 * kCell);
  }
}

TEST(Layout, BalanceAsksForTheCentreOfMassAboveTheSupport) {
  Layout layout(small_rules(0.6));
  layout.add({0, 0, 0, 3 * kCell, 2 * kCell, 2 * kCell});
  Piece piece;
  piece.orientations.push_back({4 * kCell, 2 * kCell, 2 * kCell, 0, 0, 0});  // three quarters supported
  CandidatePose pose;
  EXPECT_EQ(layout.settle(piece, 0, 0, 0, pose), Refusal::None);
  piece.orientations.front().com_x = 3 * kCell / 2;  // 3.5 cells from the left, 0.5 beyond the edge
  EXPECT_EQ(layout.settle(piece, 0, 0, 0, pose), Refusal::Balance);
  layout.add({7 * kCell / 2, 0, 0, 5 * kCell, 2 * kCell, 2 * kCell});  // a second box bridges the gap
  EXPECT_EQ(layout.settle(piece, 0, 0, 0, pose), Refusal::None);
}

TEST(CandidatePoseList, RemembersOnlyThisRoundHoweverManyThereWere) {
  CandidatePoseList list;
  for (int round = 0; round < 70000; ++round) {
    list.clear();
    ASSERT_TRUE(list.is_new(1, 30, 40)) << round;
    ASSERT_FALSE(list.is_new(1, 30, 40)) << round;
  }
  for (int x = 0; x < 3000; ++x) ASSERT_TRUE(list.is_new(0, x, x));
  for (int x = 0; x < 3000; ++x) ASSERT_FALSE(list.is_new(0, x, x));
}

/// A pallet of 1200 x 800 mm.
Layout make_pallet() {
  Rules rules;
  rules.size_x = 12000;
  rules.size_y = 8000;
  rules.size_z = 18000;
  rules.has_walls = false;
  return Layout(rules);
}

/// mm, kg.
Block box_at(int x, int y, int z, int length, int width, int height, int mass) {
  return {10 * x, 10 * y, 10 * z, 10 * (x + length), 10 * (y + width), 10 * (z + height), 1000 * mass};
}

TEST(LayoutTipping, AColumnTipsAtItsWidthOverItsHeight) {
  Layout layout = make_pallet();
  for (int i = 0; i < 3; ++i) layout.add(box_at(0, 0, 300 * i, 400, 300, 300, 5));
  const auto tipping = layout.tipping_of(box_at(0, 0, 900, 400, 300, 300, 5));
  for (const std::size_t side : {0U, 1U}) EXPECT_NEAR(tipping[side], 400.0 / 1200.0, 1e-12);
  for (const std::size_t side : {2U, 3U}) EXPECT_NEAR(tipping[side], 300.0 / 1200.0, 1e-12);
  const auto alone = layout.tipping_of(box_at(600, 0, 0, 400, 300, 300, 5));
  EXPECT_NEAR(alone[0], 400.0 / 300.0, 1e-12);
}

TEST(LayoutTipping, WhatHangsOverAtTheTopTipsAllThatItStandsOn) {
  Layout layout = make_pallet();
  layout.add(box_at(200, 0, 0, 400, 300, 300, 5));
  layout.add(box_at(200, 0, 300, 400, 300, 300, 5));
  // 100 mm to the left: the whole has its middle a third of that off, 450 mm high; a box has 300 mm of face below it.
  const auto tipping = layout.tipping_of(box_at(100, 0, 600, 400, 300, 300, 5));
  EXPECT_NEAR(tipping[0], std::min(100.0 / 150.0, (200.0 - 100.0 / 3.0) / 450.0), 1e-12);
  EXPECT_NEAR(tipping[1], std::min(200.0 / 150.0, (200.0 + 100.0 / 3.0) / 450.0), 1e-12);
}

TEST(LayoutTipping, ATieSharesItsWeightBetweenTheColumnsThatItJoins) {
  Layout layout = make_pallet();
  layout.add(box_at(0, 0, 0, 400, 400, 300, 6));
  layout.add(box_at(400, 0, 0, 400, 400, 300, 6));
  // Half of it stands on either column, on 300 mm of each: 250 mm from the outer edge, 450 mm high.
  const auto tie = layout.tipping_of(box_at(100, 0, 300, 600, 400, 300, 6));
  const double lever = (6.0 * 200.0 + 3.0 * 250.0) / 9.0, height = (6.0 * 150.0 + 3.0 * 450.0) / 9.0;
  EXPECT_NEAR(tie[2], 200.0 / height, 1e-12);
  EXPECT_NEAR(tie[0], (400.0 - lever) / height, 1e-12) << "the right column's inner edge is the nearest";
  EXPECT_NEAR(tie[1], tie[0], 1e-12);
}

TEST(LayoutTipping, CostsWhereAColumnStandsByItselfAndHalfWhereANeighbourHoldsIt) {
  Layout layout = make_pallet();
  for (int i = 0; i < 3; ++i) layout.add(box_at(0, 0, 300 * i, 400, 300, 300, 5));
  Piece piece;
  piece.mass = 5000;
  piece.orientations.push_back({4000, 3000, 3000, 0, 0, 0});
  const Policy policy{pallet_weights(), WasteTable({4000}, 12000), WasteTable({3000}, 18000)};
  const CandidatePose on_top{0, 0, 9000, 0, 1.0};
  // Along x it tips at 0.33 g, along y at 0.25 g of 0.3: the edge at y = 0 holds it as little as the open side does.
  const double each = 1.0 - 0.25 / 0.3;
  EXPECT_NEAR(see(layout, policy, piece, on_top)[Tipping], 2.0 * each, 1e-12);
  layout.add(box_at(0, 300, 0, 400, 300, 1000, 5));
  EXPECT_NEAR(see(layout, policy, piece, on_top)[Tipping], 2.0 * each, 1e-12) << "it ends below the middle";
  layout.add(box_at(0, 300, 1000, 400, 300, 200, 5));
  EXPECT_NEAR(see(layout, policy, piece, on_top)[Tipping], 1.5 * each, 1e-12);
}

TEST(LayoutExposed, IsWhatStaysFreeOfTheTopsThatABoxStandsOn) {
  constexpr std::int64_t kSquareMillimetre = 100;
  Layout layout = make_pallet();
  layout.add(box_at(0, 0, 0, 400, 400, 300, 6));
  layout.add(box_at(400, 0, 0, 400, 400, 298, 6));
  layout.add(box_at(0, 400, 0, 400, 400, 290, 6));
  const Block first = box_at(0, 0, 300, 400, 300, 200, 5);
  EXPECT_EQ(layout.left_exposed(first), 400 * 100 * kSquareMillimetre);
  layout.add(first);
  EXPECT_EQ(layout.left_exposed(box_at(0, 300, 300, 400, 100, 200, 1)), 0) << "the rest of the same top";
  EXPECT_EQ(layout.left_exposed(box_at(300, 300, 300, 200, 100, 200, 1)),
            (300 * 100 + 400 * 400 - 100 * 100) * kSquareMillimetre)
      << "tops that differ by the slack carry together";
  EXPECT_EQ(layout.left_exposed(box_at(0, 400, 290, 400, 400, 200, 5)), 0) << "a lower top is another one";
  EXPECT_EQ(layout.left_exposed(box_at(800, 0, 0, 400, 400, 300, 6)), 0) << "the floor is no top";
}

TEST(LayoutExposed, CostsSoThatABoxGoesOnTheTopThatItCovers) {
  Layout layout = make_pallet();
  layout.add(box_at(0, 0, 0, 400, 400, 300, 6));
  layout.add(box_at(600, 0, 0, 400, 300, 300, 6));
  Piece piece;
  piece.mass = 5000;
  piece.orientations.push_back({4000, 3000, 2000, 0, 0, 0});
  const Policy policy{pallet_weights(), WasteTable({4000}, 12000), WasteTable({2000}, 18000)};
  const CandidatePose on_larger{0, 0, 3000, 0, 1.0}, on_equal{6000, 0, 3000, 0, 1.0};
  EXPECT_NEAR(see(layout, policy, piece, on_larger)[Exposed], 10.0 * (0.4 * 0.1) / (1.2 * 0.8), 1e-12);
  EXPECT_EQ(see(layout, policy, piece, on_equal)[Exposed], 0.0);
  EXPECT_LT(cost(layout, policy, piece, on_equal), cost(layout, policy, piece, on_larger));
}

TEST(LayoutBacking, CostsAsFarAsFilmCanPushABoxInwardBeforeANeighbourBacksIt) {
  Layout layout = make_pallet();
  layout.add(box_at(0, 0, 0, 400, 300, 300, 5));
  Piece piece;
  piece.mass = 5000;
  piece.orientations.push_back({4000, 3000, 3000, 0, 0, 0});
  const Policy policy{pallet_weights(), WasteTable({4000}, 12000), WasteTable({3000}, 18000)};
  const auto loose_at = [&](int x) { return see(layout, policy, piece, {10 * x, 0, 0, 0, 1.0})[Loose]; };
  EXPECT_EQ(loose_at(400), 0.0);
  EXPECT_EQ(loose_at(405), 0.0) << "5 mm are no matter";
  EXPECT_NEAR(loose_at(505), 100.0 / 200.0, 1e-12);
  EXPECT_EQ(loose_at(800), 1.0) << "200 mm and more are as bad as can be";
  EXPECT_EQ(see(layout, policy, piece, {8000, 4000, 0, 0, 1.0})[Loose], 0.0) << "nothing stands beside it yet";
  layout.add(box_at(800, 0, 0, 400, 300, 100, 5));
  EXPECT_NEAR(loose_at(400), 0.0, 1e-12) << "the new one ends below the middle, and the first one backs it";
}

TEST(LayoutBacking, CountsOnPalletsForCartonsThatAreNotModular) {
  Planning planning;
  planning.inner_size = {1.2, 1.0, 1.8};
  planning.has_walls = false;
  std::vector<Item> kinds(2);
  kinds[0].size = {0.6, 0.4, 0.31};
  kinds[1].size = {0.398, 0.304, 0.2};  // as measured
  EXPECT_EQ(make_policy(planning, kinds).weights[Loose], 0.0) << "rows of 400 x 300 and 600 x 400 mm have no gaps";
  kinds[1].size.x() = 0.35;
  EXPECT_EQ(make_policy(planning, kinds).weights[Loose], 0.0) << "nor those of multiples of 50 mm";
  EXPECT_GT(make_policy(planning, kinds).weights[Exposed], 0.0) << "else they are placed as others";
  kinds[1].size.x() = 0.36;
  EXPECT_GT(make_policy(planning, kinds).weights[Loose], 0.0);
  kinds[0].size = {0.364, 0.3, 0.2};
  EXPECT_EQ(make_policy(planning, kinds).weights[Loose], 0.0) << "one size";
  EXPECT_EQ(make_policy(planning, kinds).weights[Exposed], 0.0) << "which is stacked layer by layer";
  kinds[0].size.x() = 0.38;
  planning.has_walls = true;
  EXPECT_EQ(make_policy(planning, kinds).weights[Loose], 0.0) << "no film";
}

}  // namespace
}  // namespace snug::packing::internal
