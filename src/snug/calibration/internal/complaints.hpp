// What all calibrations say about measurements that cannot be used.
#pragma once

#include <string>
#include <vector>

#include "snug/calibration/table.hpp"

namespace snug::calibration::internal {

/// InputError when the table has fewer rows.
void check_count(const Table& table, std::size_t least, const std::string& what);
/// InputError that names the lines, when there are any.
void check_outliers(const Table& table, const std::vector<std::size_t>& rows);
/// "(0.00, 0.71, 0.71)"
[[nodiscard]] std::string to_text(const Vector3& v);

}  // namespace snug::calibration::internal
