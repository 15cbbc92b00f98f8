// What all calibrations say about measurements that cannot be used.
#include "snug/calibration/internal/complaints.hpp"

#include <cstdio>

#include "snug/core/input_error.hpp"

namespace snug::calibration::internal {

void check_count(const Table& table, std::size_t least, const std::string& what) {
  if (table.rows.size() >= least) return;
  throw InputError(table.name, "", std::to_string(table.rows.size()) + " " + what, std::to_string(least) + " or more");
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
