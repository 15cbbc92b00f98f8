// The result of a run as text: a table for people, JSON for programs.
#pragma once

#include <string>

#include "snug/cell/run.hpp"

namespace snug::app {

/// Boxes (or bodies), how each got there, and the figures of the run. Lengths in mm.
[[nodiscard]] std::string format_table(const cell::RunResult& result);

/// One JSON document; the keys are described in docs/formats.md.
[[nodiscard]] std::string format_json(const cell::RunResult& result);

}  // namespace snug::app
