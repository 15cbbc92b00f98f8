// Columns of a level grid.
#include "snug/geometry/column.hpp"

#include <cmath>

namespace snug::geometry {

int column_of(double coordinate) { return static_cast<int>(std::floor(coordinate / kColumnSide)); }

}  // namespace snug::geometry
