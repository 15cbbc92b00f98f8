// ProgramRun: the two ways to run a scenario: with a program, and its bodies alone.
#pragma once

#include "snug/runs/run.hpp"

namespace snug::runs::internal {

/// Does anybody want to have the frames?
[[nodiscard]] inline bool is_recorded(const RunOptions& options) {
  return !options.record_path.empty() || options.record_file != nullptr || options.observer != nullptr;
}

[[nodiscard]] RunResult run_program(const model::Scenario& scenario, const RunOptions& options);
/// What both ways say of the contacts: the solver's summary, warnings, depths as a failure, forces at the end.
void fill_contacts(const cell::CellWorld& world, const physics::WorldState& state, const cell::SolverMonitor& monitor,
                   RunResult& result);
[[nodiscard]] RunResult run_scene(const model::Scenario& scenario, const RunOptions& options);

}  // namespace snug::runs::internal
