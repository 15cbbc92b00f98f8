// What all calibrations say about measurements that cannot be used.
#include "snug/calibration/internal/complaints.hpp"

#include <cmath>
#include <cstdio>

#include "snug/calibration/internal/frames.hpp"
#include "snug/core/input_error.hpp"

namespace snug::calibration::internal {

void check_count(const Table& table, std::size_t least, const std::string& what) {
  if (table.rows.size() >= least) return;
  throw InputError(table.name, "", std::to_string(table.rows.size()) + " " + what, std::to_string(least) + " or more");
}

void check_range(const Table& table, std::size_t column, double most, const std::string& expected) {
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double value = table.rows[row][column];
    if (std::abs(value) <= most) continue;
    throw InputError(table.where(row), column < table.columns.size() ? table.columns[column] : "", to_text(value),
                     expected);
  }
}

void check_poses(const Table& table, std::size_t first) {
  for (std::size_t i = 0; i < 3; ++i) {
    check_range(table, first + i, kFarthest, "a position in metres, at most " + to_text(kFarthest));
  }
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Vector3 turn(table.rows[row][first + 3], table.rows[row][first + 4], table.rows[row][first + 5]);
    if (turn.norm() <= kLargestTurn) continue;
    throw InputError(table.where(row), "rx,ry,rz", to_text(turn),
                     "a rotation vector in rad, no longer than a full turn");
  }
}

void check_outliers(const Table& table, const std::vector<std::size_t>& rows) {
  if (rows.empty()) return;
  std::string lines;
  for (const std::size_t row : rows) lines += (lines.empty() ? "" : ", ") + std::to_string(table.lines[row]);
  throw InputError(table.where(rows.front()), "",
                   std::to_string(rows.size()) + " of " + std::to_string(table.rows.size()) +
                       " rows more than 6 standard deviations off the rest (line " + lines + ")",
                   "measurements of one kind: remove these rows or measure them again");
}

std::string to_text(const Vector3& v) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, "(%.2f, %.2f, %.2f)", v.x(), v.y(), v.z());
  return buffer;
}

}  // namespace snug::calibration::internal
