// Columns of measured tables: groups that are there whole or not at all, rotations as quaternions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/core/table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::identification::internal {

/// Where the group's first column stands in the table, or nothing when none of its columns are there. InputError that
/// names a missing one when only some are.
[[nodiscard]] std::optional<std::size_t> find_group(const Table& table, const std::vector<std::string>& group);

[[nodiscard]] Vector3 vector_at(const Table& table, std::size_t row, std::size_t first);
/// From w, x, y, z; InputError with file, line and column when they are no rotation.
[[nodiscard]] Matrix3 rotation_at(const Table& table, std::size_t row, std::size_t first);

}  // namespace snug::identification::internal
