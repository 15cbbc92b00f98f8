// SolverSummary: how well the contact solver did over a run.
#pragma once

#include <cstdint>
#include <string>

#include "snug/cell/world_builder.hpp"

namespace snug::cell {

struct SolverSummary {
  std::int64_t steps = 0;
  std::int64_t not_converged = 0;
  double worst_residual = 0.0;     ///< m/s
  double worst_penetration = 0.0;  ///< m, rigid contacts
  double mean_sweeps = 0.0;        ///< over steps with contacts
};

/// Gathers a SolverSummary step by step.
class SolverMonitor {
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

}  // namespace snug::cell
