// Conversions: rounding to ticks, and from candidate poses back to metres.
#include "snug/packing/internal/convert.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snug::packing::internal {

namespace {

/// More tilt than this and a box is seen as all the space around it, rad (6 degrees).
constexpr double kUprightTilt = 0.105;
/// m: neighbours nearer to the rim of a side than this count for `side_height`.
constexpr double kBeside = 0.060;

// m, kept to obstacles. Beside: boxes are let down up to 10 mm off their place and slid, and pushed against what is
// within 7 mm (skills/item_plan.cpp). Over: what carries a box beside an obstacle gives way a little.
constexpr double kObstacleSide = 0.012, kObstacleTop = 0.005;

constexpr int kAligned = 30;         ///< ticks: edges that lie nearer to each other were planned on one line
constexpr double kSameSize = 0.003;  ///< m: a box that differs by less is as large as its kind

int to_grams(double mass) { return static_cast<int>(std::lround(std::clamp(mass * 1000.0, 0.0, 1.0e9))); }

int capacity(const Item& item) {
  if (item.no_stack) return 0;
  return item.max_load ? to_grams(*item.max_load) : Block::kNoLimit;
}

Layout stack(const Planning& planning, const Rules& rules, std::vector<Block> blocks,
             const std::vector<Extent>& obstacles) {
  Layout layout(rules);
  for (const Extent& obstacle : obstacles) blocks.push_back(to_block(planning, obstacle));
  // From below: what rests on a box has to come after it.
  std::stable_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) { return a.z1 < b.z1; });
  for (const Block& block : blocks) layout.add(block);
  return layout;
}

/// Gives a side its length, about the same middle, and moves it by the least way that brings one of its ends to an
/// edge. Its ends are edges then.
void align(std::vector<int>& edges, int length, int& low, int& high) {
  low = (low + high - length) / 2;
  high = low + length;
  int way = kAligned + 1;
  for (const int edge : edges) {
    for (const int end : {low, high}) {
      if (std::abs(edge - end) < std::abs(way)) way = edge - end;
    }
  }
  if (std::abs(way) <= kAligned) low += way, high += way;
  edges.insert(edges.end(), {low, high});
}

/// By how much to go up to be clear on both sides, where `low` and `high` are the gaps to what stands there; half way
/// where there is too little room. The block stays within the rim, which is `to_low` and `to_high` away.
int way_between(int low, int high, int to_low, int to_high) {
  int way = 0;
  if (low < 0 || high < 0) way = low + high <= 0 ? (high - low) / 2 : low < 0 ? -low : high;
  return to_low + to_high < 0 ? (to_high - to_low) / 2 : std::clamp(way, -to_low, to_high);
}

void look_beside(const Planning& planning, const Layout& layout, const Block& me, Candidate& candidate) {
  const Rules& rules = layout.rules();
  std::array<int, 4> gap = {me.x1, rules.size_x - me.x2, me.y1, rules.size_y - me.y2};
  std::array<int, 4> height{};
  const int near = to_ticks(kBeside);
  for (std::size_t side = 0; side < 4; ++side) height[side] = gap[side] <= near ? rules.size_z - me.z1 : 0;
  for (const Block& b : layout.blocks()) {
    const int ox = std::min(me.x2, b.x2) - std::max(me.x1, b.x1);
    const int oy = std::min(me.y2, b.y2) - std::max(me.y1, b.y1);
    if (b.z2 <= me.z1 || (ox > 0) == (oy > 0)) continue;
    const std::size_t side = oy > 0 ? (b.x1 < me.x1 ? 0U : 1U) : (b.y1 < me.y1 ? 2U : 3U);
    const int free = oy > 0 ? -ox : -oy;
    gap[side] = std::min(gap[side], free);
    if (free <= near) height[side] = std::max(height[side], b.z2 - me.z1);
  }
  // Ticks are of boxes less the planned interference: measured ones have half of it less to the wall, all of it to a
  // box.
  for (std::size_t side = 0; side < 4; ++side) {
    candidate.side_gap[side] = gap[side] / kTicksPerMetre - planning.planned_interference;
    candidate.side_height[side] = height[side] / kTicksPerMetre;
  }
}

}  // namespace

int to_ticks(double metres) {
  return static_cast<int>(std::lround(std::clamp(metres, -100.0, 100.0) * kTicksPerMetre));
}

Rules make_rules(const Planning& planning, std::span<const Item> kinds) {
  const PackingSettings& s = planning.settings;
  Rules rules;
  rules.size_x = to_ticks(planning.inner_size.x());
  rules.size_y = to_ticks(planning.inner_size.y());
  rules.size_z = to_ticks(planning.inner_size.z());
  rules.margin = to_ticks(planning.margin);
  rules.min_support = s.min_support;
  rules.com_margin = to_ticks(s.com_margin);
  rules.level_slack = to_ticks(s.level_slack);
  rules.has_walls = planning.has_walls;
  int smallest = std::numeric_limits<int>::max();
  for (const Item& kind : kinds)
    smallest = std::min(smallest, to_ticks(kind.size.minCoeff() - planning.planned_interference));
  if (!kinds.empty()) {
    rules.min_side = std::max(1, smallest);
    rules.min_height = std::max(1, smallest);
  }
  return rules;
}

Block to_block(const Planning& planning, const PlacedBox& box) {
  const Extent around = bounding_extent(box);
  Extent seen = around;
  if (tilt(box) <= kUprightTilt) {
    // A corner that sticks out by the tilt can be pushed back half of it, and tops are met half way.
    const Extent upright = upright_extent(box);
    seen.low = 0.5 * (upright.low + around.low);
    seen.high = 0.5 * (upright.high + around.high);
  }
  const double half = 0.5 * planning.planned_interference;
  Block block;
  block.x1 = to_ticks(seen.low.x() + 0.5 * planning.inner_size.x() + half);
  block.y1 = to_ticks(seen.low.y() + 0.5 * planning.inner_size.y() + half);
  block.z1 = to_ticks(seen.low.z());
  block.x2 = std::max(block.x1 + 1, to_ticks(seen.high.x() + 0.5 * planning.inner_size.x() - half));
  block.y2 = std::max(block.y1 + 1, to_ticks(seen.high.y() + 0.5 * planning.inner_size.y() - half));
  block.z2 = std::max(block.z1 + 1, to_ticks(seen.high.z()));
  block.mass = to_grams(box.item.mass);
  block.capacity = capacity(box.item);
  return block;
}

/// Thin, at its top: what is under it is full or lost, and boxes under it come before it.
Block to_block(const Planning& planning, const Extent& obstacle) {
  Block block;
  const Vector3 corner(0.5 * planning.inner_size.x(), 0.5 * planning.inner_size.y(), 0.0);
  const Vector3 low = obstacle.low + corner - Vector3::Constant(kObstacleSide);
  const Vector3 high = obstacle.high + corner + Vector3(kObstacleSide, kObstacleSide, kObstacleTop);
  block.x1 = to_ticks(low.x());
  block.y1 = to_ticks(low.y());
  block.x2 = std::max(block.x1 + 1, to_ticks(high.x()));
  block.y2 = std::max(block.y1 + 1, to_ticks(high.y()));
  block.z2 = std::max(1, to_ticks(high.z()));
  block.z1 = block.z2 - 1;
  block.is_obstacle = true;
  return block;
}

Layout to_layout(const Planning& planning, const Rules& rules, const ContainerState& state) {
  std::vector<Block> blocks;
  for (const PlacedBox& box : state.boxes) blocks.push_back(to_block(planning, box));
  return stack(planning, rules, std::move(blocks), state.obstacles);
}

Layout to_aligned_layout(const Planning& planning, const Rules& rules, const ContainerState& state,
                         std::span<const Item> kinds) {
  const int interference = to_ticks(planning.planned_interference);
  std::vector<Block> blocks;
  std::vector<int> edges_x{0, rules.size_x}, edges_y{0, rules.size_y};
  for (const PlacedBox& box : state.boxes) {
    Block& block = blocks.emplace_back(to_block(planning, box));
    if (tilt(box) > kUprightTilt) continue;
    const Extent upright = upright_extent({with_size_of_kind(box.item, kinds), box.X_TP});
    const Vector3 size = upright.high - upright.low;
    align(edges_x, to_ticks(size.x()) - interference, block.x1, block.x2);
    align(edges_y, to_ticks(size.y()) - interference, block.y1, block.y2);
  }
  return stack(planning, rules, std::move(blocks), state.obstacles);
}

Item with_size_of_kind(Item item, std::span<const Item> kinds) {
  const auto kind = std::ranges::find_if(kinds, [&item](const Item& other) {
    return other.type == item.type && (other.size - item.size).lpNorm<Eigen::Infinity>() <= kSameSize;
  });
  if (kind != kinds.end()) item.size = kind->size;
  return item;
}

Choice make_choice(const Planning& planning, const Item& item) {
  const PackingSettings& s = planning.settings;
  Choice choice;
  choice.piece.mass = to_grams(item.mass);
  choice.piece.capacity = capacity(item);
  choice.piece.volume = item.size.prod();
  const int interference = to_ticks(planning.planned_interference);
  for (const Orientation& orientation : allowed_orientations(item, planning.max_flips, true)) {
    const Vector3 e = extents(orientation, item.size);
    const double breadth = std::min(e.x(), e.y());
    if (breadth < s.min_pick_face || breadth < s.min_slenderness * e.z()) continue;
    PieceOrientation standing;
    standing.width = std::max(1, to_ticks(e.x()) - interference);
    standing.depth = std::max(1, to_ticks(e.y()) - interference);
    standing.height = to_ticks(e.z());
    const auto known = std::find(choice.piece.orientations.begin(), choice.piece.orientations.end(), standing);
    if (known != choice.piece.orientations.end()) {
      choice.orientations[static_cast<std::size_t>(known - choice.piece.orientations.begin())].push_back(orientation);
    } else {
      choice.piece.orientations.push_back(standing);
      choice.orientations.push_back({orientation});
    }
  }
  return choice;
}

std::optional<NoPlace> refuse(const Planning& planning, const Item& item, const Choice& choice) {
  if (item.mass > planning.settings.max_item_mass) return NoPlace::TooHeavy;
  const double free_x = planning.inner_size.x() - 2.0 * planning.margin + planning.planned_interference;
  const double free_y = planning.inner_size.y() - 2.0 * planning.margin + planning.planned_interference;
  bool fits = false;
  for (const Orientation& orientation : allowed_orientations(item, planning.max_flips, true)) {
    const Vector3 e = extents(orientation, item.size);
    fits |= e.x() <= free_x && e.y() <= free_y && e.z() <= planning.inner_size.z();
  }
  if (!fits) return NoPlace::TooBig;
  if (choice.piece.orientations.empty()) return NoPlace::NotPickable;
  return std::nullopt;
}

Expected<Candidate, NoPlace> place_item(const Planning& planning, const Layout& layout, const Item& item,
                                        const Choice& choice, const CandidatePose& pose,
                                        const std::function<bool(const Placement&)>& is_reachable) {
  std::vector<Orientation> ways = choice.orientations[static_cast<std::size_t>(pose.orientation)];
  std::stable_sort(ways.begin(), ways.end(), [&](const Orientation& a, const Orientation& b) {
    return count_flips(item.arrival, a) < count_flips(item.arrival, b);
  });
  Piece piece = choice.piece;
  PieceOrientation& orientation = piece.orientations[static_cast<std::size_t>(pose.orientation)];
  NoPlace reason = NoPlace::NoStablePlace;
  for (const Orientation& way : ways) {
    const Matrix3 R_TP = rotation(way);
    const Vector3 com = R_TP * item.com;
    orientation.com_x = to_ticks(com.x());
    orientation.com_y = to_ticks(com.y());
    CandidatePose settled;
    if (layout.settle(piece, pose.orientation, pose.x, pose.y, settled) != Refusal::None) continue;
    const Block me = Layout::block_at(piece, settled);
    Candidate candidate;
    candidate.placement.item = item.id;
    candidate.placement.orientation = way;
    candidate.placement.flips = count_flips(item.arrival, way);
    candidate.placement.X_TP.R = R_TP;
    candidate.placement.X_TP.p =
        Vector3(0.5 * (me.x1 + me.x2), 0.5 * (me.y1 + me.y2), 0.5 * (me.z1 + me.z2)) / kTicksPerMetre -
        Vector3(0.5 * planning.inner_size.x(), 0.5 * planning.inner_size.y(), 0.0);
    candidate.support = settled.support;
    look_beside(planning, layout, me, candidate);
    if (!is_reachable || is_reachable(candidate.placement)) return candidate;
    reason = NoPlace::NotReachable;
  }
  return tl::unexpected(reason);
}

bool make_clear(const Planning& planning, const Layout& layout, const Item& item, int base, Candidate& candidate) {
  const Rules& rules = layout.rules();
  Vector3& p = candidate.placement.X_TP.p;
  p.z() = base / kTicksPerMetre + 0.5 * extents(candidate.placement.orientation, item.size).z();
  Block block = to_block(planning, {item, candidate.placement.X_TP});
  const std::array<int, 4> rim = {block.x1, rules.size_x - block.x2, block.y1, rules.size_y - block.y2};
  std::array<int, 4> gap = rim;
  for (const Block& b : layout.blocks()) {
    if (b.z2 - block.z1 <= rules.level_slack || b.z1 >= block.z2) continue;
    const int ox = std::min(block.x2, b.x2) - std::max(block.x1, b.x1);
    const int oy = std::min(block.y2, b.y2) - std::max(block.y1, b.y1);
    if (ox <= 0 && oy <= 0) continue;
    const bool is_along_x = ox < oy;
    const bool is_low = is_along_x ? b.x1 + b.x2 < block.x1 + block.x2 : b.y1 + b.y2 < block.y1 + block.y2;
    int& least = gap[(is_along_x ? 0U : 2U) + (is_low ? 0U : 1U)];
    least = std::min(least, -std::min(ox, oy));
  }
  const int dx = way_between(gap[0], gap[1], rim[0], rim[1]), dy = way_between(gap[2], gap[3], rim[2], rim[3]);
  if (std::min({gap[0] + dx, gap[1] - dx, gap[2] + dy, gap[3] - dy}) < -kAligned) return false;
  p += Vector3(dx, dy, 0.0) / kTicksPerMetre;
  block.x1 += dx, block.x2 += dx, block.y1 += dy, block.y2 += dy;
  look_beside(planning, layout, block, candidate);
  return true;
}

}  // namespace snug::packing::internal
