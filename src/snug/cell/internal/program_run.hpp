// ProgramRun: the two ways to run a scenario: with a program, and its bodies alone.
#pragma once

#include "snug/cell/run.hpp"

namespace snug::cell::internal {

[[nodiscard]] RunResult run_program(const model::Scenario& scenario, const RunOptions& options);
[[nodiscard]] RunResult run_scene(const model::Scenario& scenario, const RunOptions& options);

}  // namespace snug::cell::internal
