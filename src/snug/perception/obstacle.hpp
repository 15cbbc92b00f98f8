// Obstacle: something in the cell that nobody expected, as columns of a level grid, and boxes that cover it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "snug/geometry/bounds.hpp"
#include "snug/geometry/column.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::perception {

using geometry::Column;
using geometry::column_of;
using geometry::kColumnSide;

/// What is seen of something that is neither surroundings nor an expected box. What is under its columns is not seen.
struct Obstacle {
  std::vector<Column> columns;  ///< never empty; by y, then x
  double deviation = 0.0;       ///< m, standard deviation of its tops and of its edges
  bool operator==(const Obstacle&) const = default;
};

/// Highest point seen over each column of a rectangle of the grid.
struct HeightMap {
  static constexpr float kUnseen = -1e9F;
  int x = 0, y = 0;           ///< its first column
  int cols = 0, rows = 0;     ///< along Wx, Wy
  std::vector<float> height;  ///< m, z in W, row by row; kUnseen where nothing was seen
  /// Nothing outside of the map and where nothing was seen.
  [[nodiscard]] std::optional<double> at(int column_x, int column_y) const;
  bool operator==(const HeightMap&) const = default;
};

/// The columns that a box touches, each as high as the box is there.
[[nodiscard]] std::vector<Column> columns_of_box(const Pose& X_WP, const Vector3& size);
/// Smallest box around columns: upper.z is the highest top, lower.z the lowest.
[[nodiscard]] geometry::Aabb bounds_of(std::span<const Column> columns);
/// At most `most` boxes that together cover all columns up to their tops, with little beside: they stand on `floor`
/// [m, z in W], and parts are split where that saves most.
[[nodiscard]] std::vector<geometry::Aabb> cover(std::vector<Column> columns, double floor, int most);

}  // namespace snug::perception
