// The result of packing as text: a table for people, JSON for programs.
#pragma once

#include <string>

#include "snug/task/executions.hpp"

namespace snug::app {

/// Executions with count 0 are left out.
[[nodiscard]] std::string format_table(const task::SessionResult& result, const task::ExecutionResult& executions);
/// The keys are described in docs/packing-execution.md.
[[nodiscard]] std::string format_json(const task::SessionResult& result, const task::ExecutionResult& executions);
/// The placements, in the order of packing.
[[nodiscard]] std::string format_plan(const task::SessionResult& result);

}  // namespace snug::app
