// Columns of measured tables.
#include "snug/identification/internal/measured_table.hpp"

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/identification/internal/json_file.hpp"

namespace snug::identification::internal {

std::optional<std::size_t> find_group(const Table& table, const std::vector<std::string>& group) {
  std::string missing;
  std::optional<std::size_t> first;
  for (const std::string& column : group) {
    const auto found = std::find(table.columns.begin(), table.columns.end(), column);
    if (found == table.columns.end())
      missing += (missing.empty() ? "" : ", ") + column;
    else if (!first)
      first = static_cast<std::size_t>(found - table.columns.begin());
  }
  if (!first || missing.empty()) return first;
  throw InputError(table.name, "column '" + table.columns[*first] + "'", "it without " + missing,
                   "all columns of a group, or none");
}

Vector3 vector_at(const Table& table, std::size_t row, std::size_t first) {
  const std::vector<double>& cells = table.rows[row];
  return {cells[first], cells[first + 1], cells[first + 2]};
}

Matrix3 rotation_at(const Table& table, std::size_t row, std::size_t first) {
  Matrix3 R;
  if (!rotation_from_quaternion(table.rows[row].data() + first, R))
    throw InputError(table.where(row), table.columns[first], "four numbers that are no rotation",
                     "a quaternion w, x, y, z of length 1 within 0.001");
  return R;
}

}  // namespace snug::identification::internal
