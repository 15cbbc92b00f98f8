// What all calibrations say about measurements that cannot be used.
#pragma once

#include <string>
#include <vector>

#include "snug/core/table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::calibration::internal {

/// InputError when the table has fewer rows.
void check_count(const Table& table, std::size_t least, const std::string& what);
/// Beyond these a number is a slip, such as millimetres or degrees.
inline constexpr double kFarthest = 10.0;      ///< m, of a measured position
inline constexpr double kLargestTurn = 6.31;   ///< rad, length of a rotation vector: a full turn, rounded
inline constexpr double kLongestTool = 2.0;    ///< m, from the flange or the sensor to what is behind it
inline constexpr double kLargestForce = 1e4;   ///< N
inline constexpr double kLargestTorque = 1e3;  ///< Nm

/// InputError with line and column for the first number of `column` beyond +-most.
void check_range(const Table& table, std::size_t column, double most, const std::string& expected);
/// The same for the six columns of a pose (row_pose) from `first` on.
void check_poses(const Table& table, std::size_t first);
/// InputError that names the lines, when there are any.
void check_outliers(const Table& table, const std::vector<std::size_t>& rows);
/// "(0.00, 0.71, 0.71)"
[[nodiscard]] std::string to_text(const Vector3& v);

}  // namespace snug::calibration::internal
