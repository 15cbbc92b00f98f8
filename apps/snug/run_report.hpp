// The result of a run as text: a table for people, JSON for programs.
#pragma once

#include <string>

#include "snug/cell/monte_carlo.hpp"
#include "snug/cell/run.hpp"

namespace snug::app {

/// Boxes (or bodies), how each got there, and the figures of the run. Lengths in mm.
[[nodiscard]] std::string format_table(const cell::RunResult& result);

/// One JSON document; the keys are described in docs/formats.md.
[[nodiscard]] std::string format_json(const cell::RunResult& result);

/// The same for repeated runs: a line a run, and the spread.
[[nodiscard]] std::string format_table(const cell::MonteCarloResult& result);
[[nodiscard]] std::string format_json(const cell::MonteCarloResult& result);

}  // namespace snug::app
