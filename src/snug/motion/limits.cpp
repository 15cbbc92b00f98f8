// MotionLimits: how fast the tool may move to a waypoint and when it has arrived, chosen by the waypoint's name.
#include "snug/motion/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

// SI units. Wide enough for anything that moves, narrow enough that no duration overflows.
constexpr double kSmallest = 1e-9;
constexpr double kLargest = 1e9;

}  // namespace

const NamedLimits* match_limits(std::string_view name, std::span<const NamedLimits> table) noexcept {
  const auto last = std::find_if(table.rbegin(), table.rend(),
                                 [&](const NamedLimits& entry) { return name.starts_with(entry.prefix); });
  return last == table.rend() ? nullptr : &*last;
}

const MotionLimits& find_limits(const Program& program, std::size_t row, std::span<const NamedLimits> table) {
  const std::string name = name_of(program.waypoints[row]);
  if (const NamedLimits* entry = match_limits(name, table)) return entry->limits;
  std::vector<std::string> prefixes;
  std::string known;
  for (const NamedLimits& entry : table) {
    prefixes.push_back(entry.prefix);
    known += (known.empty() ? "" : ", ") + entry.prefix;
  }
  // Compare without the box, which no prefix has.
  const std::string_view stem = std::string_view(name).substr(0, name.find_first_of("(0123456789"));
  const std::string_view nearest = find_nearest(stem, prefixes);
  std::string expected =
      table.empty() ? "a table of limits that is not empty" : "a name that starts with one of " + known;
  if (!nearest.empty()) expected += fmt::format(" (nearest: {})", nearest);
  throw InputError(place_of(program, row), "column 7 (name)", name, expected);
}

void check_limits(std::span<const NamedLimits> table, const std::string& where) {
  for (const NamedLimits& entry : table) {
    const MotionLimits& m = entry.limits;
    const std::array<std::pair<const char*, double>, 5> values = {{{"precision", m.precision},
                                                                   {"max_acceleration", m.max_acceleration},
                                                                   {"max_speed", m.max_speed},
                                                                   {"max_turn_speed", m.max_turn_speed},
                                                                   {"max_turn_acceleration", m.max_turn_acceleration}}};
    for (const auto& [key, value] : values) {
      if (value >= kSmallest && value <= kLargest) continue;  // false for NaN
      throw InputError(where, fmt::format("limits of {}: {}", entry.prefix, key), fmt::format("{}", value),
                       "a number between 1e-9 and 1e9");
    }
  }
}

}  // namespace snug::motion
