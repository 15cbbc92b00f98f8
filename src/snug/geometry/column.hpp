// Columns of a level grid: what stands on the ground, by the highest point over each square of it.
#pragma once

namespace snug::geometry {

/// m, side of the columns; column (0, 0) of the grid has its lower corner at the origin of W.
inline constexpr double kColumnSide = 0.005;

/// A column of the grid and the highest point that was seen over it.
struct Column {
  int x = 0, y = 0;  ///< of the grid, along Wx and Wy
  double top = 0.0;  ///< m, z in W
  bool operator==(const Column&) const = default;
};

/// Index of the column in which a coordinate lies, m.
[[nodiscard]] int column_of(double coordinate);

}  // namespace snug::geometry
