// ProgramRun: a program executed tick by tick in the cell.
#pragma once

#include <memory>

#include "snug/cell/recorder.hpp"
#include "snug/cell/run.hpp"

namespace snug::cell::internal {

/// Gathers what a run tells about its contact solver, and why it had to stop.
class StepMonitor {
 public:
  void add(const physics::StepReport& report);
  [[nodiscard]] SolverSummary summary() const;

 private:
  SolverSummary summary_;
  std::int64_t sweeps_ = 0;
  std::int64_t steps_with_contacts_ = 0;
};

/// Empty, or one line that names the body, the time and the last contacts.
[[nodiscard]] std::string describe_failure(const CellWorld& world, const physics::WorldState& state,
                                           const physics::Workspace& work, const physics::StepReport& report);

[[nodiscard]] RunResult run_program(const model::Scenario& scenario, const RunOptions& options);
[[nodiscard]] RunResult run_scene(const model::Scenario& scenario, const RunOptions& options);

}  // namespace snug::cell::internal
