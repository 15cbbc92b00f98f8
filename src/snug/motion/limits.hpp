// MotionLimits: how fast the tool may move to a waypoint and when it has arrived, chosen by the waypoint's name.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "snug/motion/waypoint.hpp"

namespace snug::motion {

struct MotionLimits {
  double precision = 0.005;            ///< m, arrived when |position error| + angle / angle weight <= it
  double max_acceleration = 3.0;       ///< m/s^2
  double max_speed = 0.5;              ///< m/s
  double max_turn_speed = 1.5;         ///< rad/s
  double max_turn_acceleration = 1.5;  ///< rad/s^2
  bool operator==(const MotionLimits&) const = default;
};

/// Limits of the motion to a waypoint whose name starts with `prefix` (case counts).
struct NamedLimits {
  std::string prefix;
  MotionLimits limits;
  bool operator==(const NamedLimits&) const = default;
};

/// The last entry of the table whose prefix begins `name`, or nullptr.
[[nodiscard]] const NamedLimits* match_limits(std::string_view name, std::span<const NamedLimits> table) noexcept;

/// Limits of row `row`. Throws InputError with file and line and the known prefixes when no entry matches.
[[nodiscard]] const MotionLimits& find_limits(const Program& program, std::size_t row,
                                              std::span<const NamedLimits> table);

/// Throws InputError naming the prefix and the key when a limit is not between 1e-9 and 1e9. `where`: whose
/// table.
void check_limits(std::span<const NamedLimits> table, const std::string& where);

}  // namespace snug::motion
