// Obstacle: columns of a box by vertical rays; a cover by cutting the part that wastes most where that saves most.
#include "snug/perception/obstacle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/core/check.hpp"

namespace snug::perception {
namespace {

constexpr double kSmallWaste = 0.15;  // of the volume under the columns: not worth another box

/// The highest point of a box on the vertical through (x, y), by the slabs of its faces.
std::optional<double> top_of_box(const Pose& X_PW, const Vector3& half, double x, double y) {
  const Vector3 start = X_PW * Vector3(x, y, 0.0), up = X_PW.R.col(2);
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(up[axis]) < 1e-12) {
      if (std::abs(start[axis]) > half[axis]) return std::nullopt;
      continue;
    }
    const double a = (-half[axis] - start[axis]) / up[axis], b = (half[axis] - start[axis]) / up[axis];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return low <= high ? std::optional<double>(high) : std::nullopt;
}

/// Volume under a part's bounds and under its columns, over the floor, in columns times metres.
struct Part {
  std::vector<Column> columns;
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;  ///< x2, y2: behind the last
  double top = 0.0, filled = 0.0, whole = 0.0;
  [[nodiscard]] double waste() const { return whole - filled; }
};

Part make_part(std::vector<Column> columns, double floor) {
  Part part;
  part.x1 = part.y1 = std::numeric_limits<int>::max();
  part.x2 = part.y2 = std::numeric_limits<int>::min();
  part.top = columns.front().top;
  for (const Column& one : columns) {
    part.x1 = std::min(part.x1, one.x);
    part.y1 = std::min(part.y1, one.y);
    part.x2 = std::max(part.x2, one.x + 1);
    part.y2 = std::max(part.y2, one.y + 1);
    part.top = std::max(part.top, one.top);
    part.filled += std::max(0.0, one.top - floor);
  }
  part.whole = static_cast<double>(part.x2 - part.x1) * (part.y2 - part.y1) * std::max(0.0, part.top - floor);
  part.columns = std::move(columns);
  return part;
}

/// In two where the sum of their wastes is least; nothing when the part is one column.
std::optional<std::pair<Part, Part>> cut(const Part& part, double floor) {
  std::optional<std::pair<Part, Part>> best;
  for (const bool along_x : {true, false}) {
    const int first = along_x ? part.x1 : part.y1, end = along_x ? part.x2 : part.y2;
    for (int at = first + 1; at < end; ++at) {
      std::vector<Column> low, high;
      for (const Column& one : part.columns) ((along_x ? one.x : one.y) < at ? low : high).push_back(one);
      if (low.empty() || high.empty()) continue;
      Part a = make_part(std::move(low), floor), b = make_part(std::move(high), floor);
      if (best && a.waste() + b.waste() >= best->first.waste() + best->second.waste()) continue;
      best.emplace(std::move(a), std::move(b));
    }
  }
  return best;
}

}  // namespace

std::optional<double> HeightMap::at(int column_x, int column_y) const {
  const int c = column_x - x, r = column_y - y;
  if (c < 0 || r < 0 || c >= cols || r >= rows) return std::nullopt;
  const float value =
      height[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c)];
  return value == kUnseen ? std::nullopt : std::optional<double>(value);
}

std::vector<Column> columns_of_box(const Pose& X_WP, const Vector3& size) {
  const geometry::Aabb around = geometry::bounds(geometry::Box{0.5 * size}, X_WP);
  const Pose X_PW = X_WP.inverse();
  std::vector<Column> columns;
  for (int y = column_of(around.lower.y()); y <= column_of(around.upper.y()); ++y) {
    for (int x = column_of(around.lower.x()); x <= column_of(around.upper.x()); ++x) {
      std::optional<double> top;
      for (int i = 0; i < 9; ++i) {  // corners, middles of sides, middle
        const auto here =
            top_of_box(X_PW, 0.5 * size, (x + 0.5 * (i % 3)) * kColumnSide, (y + 0.5 * (i / 3)) * kColumnSide);
        if (here && (!top || *here > *top)) top = here;
      }
      if (top) columns.push_back({x, y, *top});
    }
  }
  return columns;
}

geometry::Aabb bounds_of(std::span<const Column> columns) {
  SNUG_CHECK(!columns.empty(), "an obstacle has columns");
  const double most = std::numeric_limits<double>::max();
  geometry::Aabb bounds{Vector3::Constant(most), Vector3::Constant(-most)};
  for (const Column& one : columns) {
    const Vector3 low(one.x * kColumnSide, one.y * kColumnSide, one.top);
    bounds.lower = bounds.lower.cwiseMin(low);
    bounds.upper = bounds.upper.cwiseMax(low + Vector3(kColumnSide, kColumnSide, 0.0));
  }
  return bounds;
}

std::vector<geometry::Aabb> cover(std::vector<Column> columns, double floor, int most) {
  if (columns.empty()) return {};
  std::vector<Part> parts{make_part(std::move(columns), floor)};
  const double filled = parts[0].filled;
  while (static_cast<int>(parts.size()) < most) {
    const auto worst = std::ranges::max_element(parts, {}, &Part::waste);
    if (worst->waste() <= kSmallWaste * filled) break;
    auto pieces = cut(*worst, floor);
    if (!pieces) break;
    *worst = std::move(pieces->first);
    parts.push_back(std::move(pieces->second));
  }
  std::vector<geometry::Aabb> boxes;
  for (const Part& part : parts) {
    boxes.push_back({Vector3(part.x1 * kColumnSide, part.y1 * kColumnSide, floor),
                     Vector3(part.x2 * kColumnSide, part.y2 * kColumnSide, part.top)});
  }
  return boxes;
}

}  // namespace snug::perception
