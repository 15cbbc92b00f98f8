// Layout: maximal spaces open to the top at every level, kept as boxes come in.
#include "snug/packing/internal/layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace snug::packing::internal {

namespace {

bool overlaps(const Rectangle& a, const Rectangle& b) {
  return a.x1 < b.x2 && b.x1 < a.x2 && a.y1 < b.y2 && b.y1 < a.y2;
}

bool contains(const Rectangle& outer, const Rectangle& inner) {
  return outer.x1 <= inner.x1 && outer.y1 <= inner.y1 && outer.x2 >= inner.x2 && outer.y2 >= inner.y2;
}

Rectangle footprint(const Block& b) { return {b.x1, b.y1, b.x2, b.y2}; }

Rectangle around(const Rectangle& a, const Rectangle& b) {
  return {std::min(a.x1, b.x1), std::min(a.y1, b.y1), std::max(a.x2, b.x2), std::max(a.y2, b.y2)};
}

Vector3 middle_of(const Block& b) { return {0.5 * (b.x1 + b.x2), 0.5 * (b.y1 + b.y2), 0.5 * (b.z1 + b.z2)}; }

/// ticks^2: 21.5 m^2 would not fit into 31 bits.
std::int64_t area_of(const Rectangle& a) { return std::int64_t{a.x2 - a.x1} * (a.y2 - a.y1); }

std::int64_t shared_area(const Rectangle& a, const Block& b) {
  const int ox = std::min(a.x2, b.x2) - std::max(a.x1, b.x1);
  const int oy = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
  return ox > 0 && oy > 0 ? std::int64_t{ox} * oy : 0;
}

/// Levels are whole millimetres, rounded up: boxes that were looked at stand at any height.
int level_of(int top) { return (top + kTicksPerMillimetre - 1) / kTicksPerMillimetre * kTicksPerMillimetre; }

struct Point {
  double x, y;
};

double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Counter-clockwise hull by Andrew's monotone chain.
std::vector<Point> convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
  std::vector<Point> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Point& p : points) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace

void CandidatePoseList::clear() {
  poses.clear();
  used_ = 0;
  if (++round_ < 0x10000U) return;
  round_ = 1;
  std::fill(table_.begin(), table_.end(), 0);
}

bool CandidatePoseList::is_new(int orientation, int x, int y) {
  if (2 * used_ >= table_.size()) {
    std::vector<std::uint64_t> old(4 * table_.size(), 0);
    old.swap(table_);
    used_ = 0;
    for (const std::uint64_t key : old) {
      if (key >> 48U == round_) insert(key);
    }
  }
  // 20 bits for each coordinate (100 m), 8 for the orientation, the rest tells rounds apart: older entries count as
  // empty.
  return insert((round_ << 48U) | (static_cast<std::uint64_t>(orientation & 0xff) << 40U) |
                (static_cast<std::uint64_t>(x & 0xfffff) << 20U) | static_cast<std::uint64_t>(y & 0xfffff));
}

bool CandidatePoseList::insert(std::uint64_t key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 40U) & mask;
  for (; table_[at] >> 48U == round_; at = (at + 1) & mask) {
    if (table_[at] == key) return false;
  }
  table_[at] = key;
  ++used_;
  return true;
}

Layout::Layout(const Rules& rules) : rules_(rules) {
  spaces_.push_back({0, {0, 0, rules.size_x, rules.size_y}, true});
  levels_.push_back(0);
}

Block Layout::block_at(const Piece& piece, const CandidatePose& pose) {
  const PieceOrientation& s = piece.orientations[static_cast<std::size_t>(pose.orientation)];
  return {pose.x, pose.y, pose.z, pose.x + s.width, pose.y + s.depth, pose.z + s.height, piece.mass, piece.capacity};
}

void Layout::add(const Block& block) {
  double below = 0.0;
  const Rectangle face = footprint(block);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const std::int64_t shared = shared_area(face, blocks_[i]);
    below += columns_[i] * static_cast<double>(shared);
    if (!rules_.has_walls && bears_at(blocks_[i], block.z1)) exposed_[i] -= shared;
  }
  const auto area = static_cast<double>(area_of(face));
  columns_.push_back(std::max(0.0, block.z2 - below / area));
  if (!rules_.has_walls) {
    const Bearing bearing = bearing_of(block);
    go_down(bearing, bearing.mass, middle_of(block), [this](int index, double mass, const Vector3& place) {
      bearings_[static_cast<std::size_t>(index)].mass += mass;
      bearings_[static_cast<std::size_t>(index)].first_moment += mass * place;
    });
    bearings_.push_back(bearing);
    exposed_.push_back(area_of(face));
  }
  blocks_.push_back(block);
  has_obstacles_ |= block.is_obstacle;
  table_.add(face, block.z2);
  if (block.capacity != Block::kNoLimit && !has_limits_) {
    has_limits_ = true;
    loads_.assign(blocks_.size() - 1, 0.0);
  }
  if (has_limits_) {
    loads_.push_back(0.0);
    add_load(blocks_.size() - 1, block.mass);
  }
  const int margin = rules_.margin;
  split_spaces({face.x1 - margin, face.y1 - margin, face.x2 + margin, face.y2 + margin}, block.z2);
  if (block.is_obstacle) return;  // no level to put anything on
  const int level = level_of(block.z2);
  if (level + rules_.min_height > rules_.size_z) return;
  for (Space& space : spaces_) {
    if (space.level >= block.z2 && space.level - block.z2 <= rules_.level_slack && overlaps(space.area, face)) {
      space.supported = true;
    }
  }
  if (std::find(levels_.begin(), levels_.end(), level) == levels_.end()) open_level(level);
}

/// Whether something that stands at a height stands on the top of a block, if it is over it.
bool Layout::bears_at(const Block& below, int base) const {
  return below.z2 <= base && base - below.z2 <= rules_.level_slack;
}

Bearing Layout::bearing_of(const Block& block) const {
  const Rectangle face = footprint(block);
  Bearing bearing;
  bearing.face = face;
  bearing.mass = block.mass;
  bearing.first_moment = bearing.mass * middle_of(block);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& below = blocks_[i];
    if (!bears_at(below, block.z1)) continue;
    const auto area = static_cast<double>(shared_area(face, below));
    if (area <= 0.0) continue;
    const Rectangle shared{std::max(face.x1, below.x1), std::max(face.y1, below.y1), std::min(face.x2, below.x2),
                           std::min(face.y2, below.y2)};
    bearing.face = bearing.count == 0 ? shared : around(bearing.face, shared);
    std::size_t at = std::min(bearing.count, Bearing::kMost - 1);
    if (bearing.count == Bearing::kMost) {
      at = static_cast<std::size_t>(std::ranges::min_element(bearing.part) - bearing.part.begin());
      if (bearing.part[at] >= area) continue;
    } else {
      ++bearing.count;
    }
    bearing.below[at] = static_cast<int>(i);
    bearing.part[at] = area;
    bearing.at[at] = Vector3(0.5 * (shared.x1 + shared.x2), 0.5 * (shared.y1 + shared.y2), 0.0);
  }
  const double total = std::accumulate(bearing.part.begin(), bearing.part.end(), 0.0);
  for (double& part : bearing.part) part /= std::max(1.0, total);
  return bearing;
}

template <class Visit>
void Layout::go_down(const Bearing& bearing, double mass, const Vector3& place, const Visit& visit) const {
  for (std::size_t i = 0; i < bearing.count; ++i) {
    const Vector3 through = bearing.count == 1 ? place : Vector3(bearing.at[i].x(), bearing.at[i].y(), place.z());
    const double part = bearing.part[i] * mass;
    visit(bearing.below[i], part, through);
    go_down(bearings_[static_cast<std::size_t>(bearing.below[i])], part, through, visit);
  }
}

std::array<double, 4> Layout::tipping_of(const Block& block) const {
  std::array<double, 4> least;
  least.fill(std::numeric_limits<double>::infinity());
  const auto judge = [&least](const Rectangle& face, int bottom, double mass, const Vector3& first_moment) {
    const Vector3 com = first_moment / mass;
    const double height = std::max(1.0, com.z() - bottom);
    const std::array<double, 4> lever{com.x() - face.x1, face.x2 - com.x(), com.y() - face.y1, face.y2 - com.y()};
    for (std::size_t side = 0; side < 4; ++side) least[side] = std::min(least[side], lever[side] / height);
  };
  const Bearing bearing = bearing_of(block);
  const double own = std::max(1.0, bearing.mass);
  judge(bearing.face, block.z1, own, own * middle_of(block));
  go_down(bearing, own, middle_of(block), [&](int index, double mass, const Vector3& place) {
    const Bearing& below = bearings_[static_cast<std::size_t>(index)];
    judge(below.face, blocks_[static_cast<std::size_t>(index)].z1, below.mass + mass,
          below.first_moment + mass * place);
  });
  return least;
}

std::int64_t Layout::left_exposed(const Block& block) const {
  const Rectangle face = footprint(block);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (!bears_at(blocks_[i], block.z1)) continue;
    const std::int64_t shared = shared_area(face, blocks_[i]);
    if (shared > 0) sum += std::max<std::int64_t>(0, exposed_[i] - shared);
  }
  return sum;
}

void Layout::cut(std::vector<Rectangle>& areas, const Rectangle& hole) {
  std::vector<Rectangle>& fresh = spare_.fresh;
  std::size_t kept = 0;
  const int side = std::max(1, rules_.min_side);
  for (const Rectangle& a : areas) {
    if (!overlaps(a, hole)) {
      areas[kept++] = a;
      continue;
    }
    if (hole.x1 - a.x1 >= side) fresh.push_back({a.x1, a.y1, hole.x1, a.y2});
    if (a.x2 - hole.x2 >= side) fresh.push_back({hole.x2, a.y1, a.x2, a.y2});
    if (hole.y1 - a.y1 >= side) fresh.push_back({a.x1, a.y1, a.x2, hole.y1});
    if (a.y2 - hole.y2 >= side) fresh.push_back({a.x1, hole.y2, a.x2, a.y2});
  }
  areas.resize(kept);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    bool inside = false;
    for (std::size_t j = 0; j < kept && !inside; ++j) inside = contains(areas[j], fresh[i]);
    for (std::size_t j = 0; j < fresh.size() && !inside; ++j) {
      inside = j != i && contains(fresh[j], fresh[i]) && (fresh[j] != fresh[i] || j < i);
    }
    if (!inside) areas.push_back(fresh[i]);
  }
  fresh.clear();
}

void Layout::split_spaces(const Rectangle& hole, int top) {
  // Spaces of one level stand together, in the order of levels_.
  std::vector<Space>& all = spare_.spaces;
  std::vector<Rectangle>& areas = spare_.areas;
  for (std::size_t begin = 0; begin < spaces_.size();) {
    std::size_t end = begin;
    bool touched = false;
    const int level = spaces_[begin].level;
    for (; end < spaces_.size() && spaces_[end].level == level; ++end) touched |= overlaps(spaces_[end].area, hole);
    if (level >= top || !touched) {
      all.insert(all.end(), spaces_.begin() + static_cast<std::ptrdiff_t>(begin),
                 spaces_.begin() + static_cast<std::ptrdiff_t>(end));
    } else {
      for (std::size_t i = begin; i < end; ++i) areas.push_back(spaces_[i].area);
      cut(areas, hole);
      for (const Rectangle& area : areas) all.push_back({level, area, is_supported(level, area)});
      areas.clear();
    }
    begin = end;
  }
  spaces_.swap(all);
  all.clear();
}

void Layout::open_level(int level) {
  levels_.push_back(level);
  std::vector<Rectangle>& areas = spare_.areas;
  areas.push_back({0, 0, rules_.size_x, rules_.size_y});
  const int m = rules_.margin;
  for (const Block& b : blocks_) {
    if (b.z2 > level) cut(areas, {b.x1 - m, b.y1 - m, b.x2 + m, b.y2 + m});
  }
  for (const Rectangle& area : areas) spaces_.push_back({level, area, is_supported(level, area)});
  areas.clear();
}

bool Layout::is_supported(int level, const Rectangle& area) const {
  return level == 0 || table_.area_held(area, level, rules_.level_slack) > 0;
}

Refusal Layout::settle(const Piece& piece, int orientation, int x, int y, CandidatePose& pose) const {
  const PieceOrientation& s = piece.orientations[static_cast<std::size_t>(orientation)];
  const Rectangle face{x, y, x + s.width, y + s.depth};
  const int margin = rules_.margin;
  if (x < margin || y < margin || face.x2 > rules_.size_x - margin || face.y2 > rules_.size_y - margin)
    return Refusal::Outside;
  const int base = table_.highest_under({x - margin, y - margin, face.x2 + margin, face.y2 + margin});
  if (base + s.height > rules_.size_z) return Refusal::Height;
  double support = 1.0;
  if (base > 0) {
    support = static_cast<double>(table_.area_held(face, base, rules_.level_slack)) /
              (static_cast<double>(s.width) * s.depth);
  }
  pose = {x, y, base, orientation, support};
  if (has_obstacles_ && rests_on_obstacle(face, base)) return Refusal::Support;
  if (support < rules_.min_support) return Refusal::Support;
  if (base > 0 && !is_balanced(face, base, x + s.width / 2 + s.com_x, y + s.depth / 2 + s.com_y))
    return Refusal::Balance;
  if (has_limits_ && base > 0 && !carries(face, base, piece.mass)) return Refusal::Load;
  return Refusal::None;
}

bool Layout::rests_on_obstacle(const Rectangle& face, int base) const {
  return std::ranges::any_of(
      blocks_, [&](const Block& b) { return b.is_obstacle && bears_at(b, base) && shared_area(face, b) > 0; });
}

bool Layout::is_balanced(const Rectangle& face, int base, int com_x, int com_y) const {
  if (rules_.min_support <= 0.0) return true;
  const int m = rules_.com_margin;
  std::vector<Point> corners;
  for (const Block& b : blocks_) {
    if (!bears_at(b, base) || shared_area(face, b) == 0) continue;
    const Rectangle r{std::max(face.x1, b.x1), std::max(face.y1, b.y1), std::min(face.x2, b.x2),
                      std::min(face.y2, b.y2)};
    if (com_x - m >= r.x1 && com_x + m <= r.x2 && com_y - m >= r.y1 && com_y + m <= r.y2) return true;
    for (const int cx : {r.x1, r.x2}) {
      for (const int cy : {r.y1, r.y2}) corners.push_back({static_cast<double>(cx), static_cast<double>(cy)});
    }
  }
  if (corners.size() <= 4) return false;
  const std::vector<Point> hull = convex_hull(std::move(corners));
  const Point com{static_cast<double>(com_x), static_cast<double>(com_y)};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point& a = hull[i];
    const Point& b = hull[(i + 1) % hull.size()];
    if (turn(a, b, com) < m * std::hypot(b.x - a.x, b.y - a.y)) return false;
  }
  return true;
}

bool Layout::carries(const Rectangle& face, int base, int mass) const {
  // As a block on trial: the loads that it would add, all the way down.
  Layout trial(rules_);
  trial.has_limits_ = true;
  trial.blocks_ = blocks_;
  trial.loads_ = loads_;
  trial.blocks_.push_back({face.x1, face.y1, base, face.x2, face.y2, base + 1, mass});
  trial.loads_.push_back(0.0);
  trial.add_load(blocks_.size(), mass);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (trial.loads_[i] > loads_[i] && trial.loads_[i] > blocks_[i].capacity) return false;
  }
  return true;
}

void Layout::add_load(std::size_t upper, double mass) {
  const Block& top = blocks_[upper];
  const Rectangle face = footprint(top);
  double total = 0.0;
  for (std::size_t i = 0; i < upper; ++i)
    total += bears_at(blocks_[i], top.z1) ? static_cast<double>(shared_area(face, blocks_[i])) : 0.0;
  if (total <= 0.0) return;
  for (std::size_t i = 0; i < upper; ++i) {
    const double shared = bears_at(blocks_[i], top.z1) ? static_cast<double>(shared_area(face, blocks_[i])) : 0.0;
    if (shared <= 0.0) continue;
    loads_[i] += mass * shared / total;
    add_load(i, mass * shared / total);
  }
}

int Layout::find_poses(const Piece& piece, CandidatePoseList& list, Refusal* worst) const {
  list.clear();
  int looked_at = 0;
  CandidatePose pose;
  const auto try_at = [&](int orientation, int x, int y) {
    if (!list.is_new(orientation, x, y)) return;
    ++looked_at;
    const Refusal refusal = settle(piece, orientation, x, y, pose);
    if (worst != nullptr && refusal != Refusal::None) *worst = std::max(*worst, refusal);
    if (refusal != Refusal::None) return;
    list.poses.push_back(pose);
  };
  const int m = rules_.margin;
  for (int orientation = 0; orientation < static_cast<int>(piece.orientations.size()); ++orientation) {
    const PieceOrientation& s = piece.orientations[static_cast<std::size_t>(orientation)];
    for (const Space& space : spaces_) {
      const Rectangle& a = space.area;
      if (!space.supported || space.level + s.height > rules_.size_z) continue;
      // Spaces reach to the walls, boxes have grown by the margin: the margin to walls comes here.
      const int x1 = std::max(a.x1, m), y1 = std::max(a.y1, m);
      const int x2 = std::min(a.x2, rules_.size_x - m) - s.width, y2 = std::min(a.y2, rules_.size_y - m) - s.depth;
      if (x2 < x1 || y2 < y1) continue;
      try_at(orientation, x1, y1);
      if (y2 > y1) try_at(orientation, x1, y2);
      if (x2 > x1) try_at(orientation, x2, y1);
      if (x2 > x1 && y2 > y1) try_at(orientation, x2, y2);
    }
    for (const Block& b : blocks_) {
      if (b.z2 + s.height > rules_.size_z) continue;
      for (const int x : {b.x1, b.x2 - s.width}) {
        for (const int y : {b.y1, b.y2 - s.depth}) try_at(orientation, x, y);
      }
    }
  }
  return looked_at;
}

}  // namespace snug::packing::internal
