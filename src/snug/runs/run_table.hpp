// The result of a run as a table for people.
#pragma once

#include <string>

#include "snug/runs/run.hpp"

namespace snug::runs {

/// Boxes (or bodies), how each got there, and the figures of the run. Lengths in mm.
[[nodiscard]] std::string format_table(const RunResult& result);

}  // namespace snug::runs
