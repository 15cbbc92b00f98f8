// The result of checking a program as text: JSON for programs, a table for people.
#pragma once

#include <string>

#include "snug/runs/program_check.hpp"

namespace snug::runs {

/// Keys: `snug check --help`. Waypoints are counted from 1.
[[nodiscard]] std::string format_json(const CheckResult& result);
/// What is in the way, what makes the robot slower, and the smallest margins. Lengths in m, angles in rad.
[[nodiscard]] std::string format_table(const CheckResult& result);

}  // namespace snug::runs
