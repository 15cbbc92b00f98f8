// ObstacleMemory: columns of a grid, added where something foreign is seen, taken away where what is behind is seen.
#include "snug/session/obstacles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "snug/geometry/bounds.hpp"
#include "snug/planning/scene.hpp"

namespace snug::session {
namespace {

using perception::Column;
using perception::Obstacle;

constexpr double kOfBox =
    0.010;  ///< m, a point so near to a box where it is believed to be, or to the floor, is theirs
constexpr std::size_t kLeastColumns = 12;  ///< 3 cm^2
constexpr double kLeastLeft = 0.4;         ///< of the columns that were seen: what has less left is gone
constexpr double kLower = 0.005;           ///< m, and three deviations: what is behind a column is seen
constexpr double kSigmas = 2.0;            ///< by which regions grow
constexpr int kMostRegions = 4;            ///< of one obstacle
constexpr double kBeside = 0.020;          ///< m, a region that reaches less than this into a box is beside it
constexpr double kGap = 0.001;             ///< m, left to a box beside
constexpr double kGapUnder = 0.004;        ///< m, left to a box under it or over it
constexpr double kThinnest = 0.002;        ///< m, bodies are not made thinner

bool is_in_box(const Column& column, const Solid& box) {
  const double side = perception::kColumnSide;
  const Vector3 p_P = box.X_WP.inverse() * Vector3((column.x + 0.5) * side, (column.y + 0.5) * side, column.top);
  // What is lower than the box is under it, or beside what carries it.
  const double bottom = geometry::bounds(geometry::Box{0.5 * box.size}, box.X_WP).lower.z();
  return ((p_P.cwiseAbs() - 0.5 * box.size).array() < kOfBox).all() && column.top > bottom;
}

bool is_in_any(const Column& column, std::span<const Solid> boxes) {
  return std::ranges::any_of(boxes, [&](const Solid& box) { return is_in_box(column, box); });
}

/// Share a column, or have two side by side.
bool touch(const std::vector<Column>& a, const std::vector<Column>& b) {
  std::set<std::pair<int, int>> around;
  for (const Column& one : a) {
    for (int i = 0; i < 9; ++i) around.emplace(one.x + i % 3 - 1, one.y + i / 3 - 1);
  }
  return std::ranges::any_of(b, [&](const Column& one) { return around.contains({one.x, one.y}); });
}

bool is_seen_through(const Column& column, double deviation, const perception::Observation& look) {
  if (!look.heights) return true;
  const std::optional<double> height = look.heights->at(column.x, column.y);
  return height && *height < column.top - kLower - 3.0 * deviation;
}

}  // namespace

std::string describe(const ObstacleReport& report) {
  const Vector3 low = 1e3 * report.low_T, high = 1e3 * report.high_T;
  return fmt::format(
      "seen from ({:.0f}, {:.0f}) to ({:.0f}, {:.0f}) mm of the container, up to {:.0f} mm over its floor", low.x(),
      low.y(), high.x(), high.y(), high.z());
}

std::vector<Obstacle> ObstacleMemory::find_foreign(const perception::Observation& look,
                                                   std::span<const Solid> boxes) const {
  std::vector<Obstacle> foreign;
  if (!look.obstacles) return foreign;
  for (Obstacle one : *look.obstacles) {
    std::erase_if(one.columns,
                  [&](const Column& column) { return column.top < X_WT_.p.z() + kOfBox || is_in_any(column, boxes); });
    if (one.columns.size() >= kLeastColumns) foreign.push_back(std::move(one));
  }
  return foreign;
}

bool ObstacleMemory::is_believed(const Obstacle& one) const {
  return std::ranges::any_of(obstacles_, [&](const Believed& known) { return touch(known.columns, one.columns); });
}

bool ObstacleMemory::has_news(const std::vector<Obstacle>& foreign, const std::vector<Obstacle>& others) const {
  return std::ranges::any_of(foreign, [&](const Obstacle& one) {
    return !is_believed(one) &&
           std::ranges::none_of(others, [&](const Obstacle& other) { return touch(other.columns, one.columns); });
  });
}

void ObstacleMemory::note(const Believed& one, double time) {
  if (std::ranges::find(reports_, one.number, &ObstacleReport::number) == reports_.end()) {
    reports_.push_back({one.number, time, {}, {}, {}});
  }
  ObstacleReport& report = *std::ranges::find(reports_, one.number, &ObstacleReport::number);
  const geometry::Aabb bounds = planning::in_container(X_WT_, perception::bounds_of(one.columns));
  report.low_T = bounds.lower;
  report.high_T = bounds.upper;
}

void ObstacleMemory::see(const perception::Observation& look, const std::vector<Obstacle>& foreign,
                         std::span<const Solid> boxes) {
  if (!look.obstacles) return;
  std::set<std::pair<int, int>> seen;
  for (const Obstacle& one : foreign) {
    for (const Column& column : one.columns) seen.emplace(column.x, column.y);
  }
  std::vector<Believed> now;
  for (const Believed& known : obstacles_) {
    Believed left = known;
    std::erase_if(left.columns, [&](const Column& column) {
      return seen.contains({column.x, column.y}) || is_seen_through(column, known.deviation, look) ||
             is_in_any(column, boxes);
    });
    now.push_back(std::move(left));
  }
  for (const Obstacle& one : foreign) {
    const auto known = std::ranges::find_if(
        obstacles_, [&](const Believed& believed) { return touch(believed.columns, one.columns); });
    const auto index = static_cast<std::size_t>(known - obstacles_.begin());
    if (known == obstacles_.end()) now.push_back({++count_, {}, 0.0, 0});
    Believed& into = known == obstacles_.end() ? now.back() : now[index];
    into.columns.insert(into.columns.end(), one.columns.begin(), one.columns.end());
    into.deviation = std::max(into.deviation, one.deviation);
    into.whole = into.columns.size();
  }
  obstacles_.clear();
  for (Believed& one : now) {
    if (static_cast<double>(one.columns.size()) >= kLeastLeft * static_cast<double>(one.whole)) {
      note(one, look.time);
      obstacles_.push_back(std::move(one));
    } else {
      std::ranges::find(reports_, one.number, &ObstacleReport::number)->gone = look.time;
    }
  }
}

std::vector<geometry::Aabb> ObstacleMemory::regions() const {
  std::vector<geometry::Aabb> regions;
  for (const Believed& one : obstacles_) {
    const double grown = kSigmas * one.deviation;
    for (geometry::Aabb region : perception::cover(one.columns, X_WT_.p.z(), kMostRegions)) {
      region.lower -= Vector3(grown, grown, 0.0);
      region.upper += Vector3::Constant(grown);
      regions.push_back(region);
    }
  }
  return regions;
}

std::vector<geometry::Aabb> clear_of(std::vector<geometry::Aabb> regions, std::span<const Solid> boxes) {
  std::vector<geometry::Aabb> bodies;
  for (geometry::Aabb body : regions) {
    for (const Solid& solid : boxes) {
      const geometry::Aabb box = geometry::bounds(geometry::Box{0.5 * solid.size}, solid.X_WP);
      if (!box.overlaps(body)) continue;
      // Out through the nearest of the box's sides, when that is near, else up from its top, or down from under it.
      double least = kBeside;
      int side = -1;
      for (int i = 0; i < 4; ++i) {
        const int axis = i / 2;
        const double into = i % 2 == 0 ? box.upper[axis] - body.lower[axis] : body.upper[axis] - box.lower[axis];
        if (into >= least) continue;
        least = into;
        side = i;
      }
      if (side >= 0) {
        (side % 2 == 0 ? body.lower : body.upper)[side / 2] += (side % 2 == 0 ? 1.0 : -1.0) * (least + kGap);
      } else if (box.upper.z() < body.upper.z()) {
        body.lower.z() = std::max(body.lower.z(), box.upper.z() + kGapUnder);
      } else {
        body.upper.z() = std::min(body.upper.z(), box.lower.z() - kGapUnder);
      }
    }
    if ((body.upper - body.lower).minCoeff() >= kThinnest) bodies.push_back(body);
  }
  return bodies;
}

}  // namespace snug::session
