// SolverSummary: how well the contact solver did over a run.
#include "snug/cell/solver_summary.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace snug::cell {

void SolverMonitor::add(const physics::StepReport& report) {
  ++summary_.steps;
  summary_.worst_residual = std::max(summary_.worst_residual, report.residual);
  summary_.worst_penetration = std::max(summary_.worst_penetration, report.worst_penetration);
  if (report.status == physics::StepStatus::NotConverged) ++summary_.not_converged;
  if (report.contacts == 0) return;
  ++steps_with_contacts_;
  sweeps_ += report.sweeps;
}

SolverSummary SolverMonitor::summary() const {
  SolverSummary summary = summary_;
  if (steps_with_contacts_ > 0) {
    summary.mean_sweeps = static_cast<double>(sweeps_) / static_cast<double>(steps_with_contacts_);
  }
  return summary;
}

std::string describe_failure(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                             const physics::StepReport& report) {
  if (report.status == physics::StepStatus::Converged || report.status == physics::StepStatus::NotConverged) return "";
  if (report.status == physics::StepStatus::TooManyPairs) {
    return fmt::format("t = {:.3f} s: more pairs of bodies near each other than there is room for",
                       state.time(world.model));
  }
  std::string text =
      fmt::format("t = {:.3f} s: {} of body '{}'", state.time(world.model),
                  report.status == physics::StepStatus::NotFinite ? "the state is not a number any more" : "lost track",
                  world.model.bodies[static_cast<std::size_t>(report.culprit.index)].name);
  for (const physics::ContactReport& contact : work.contacts()) {
    if (contact.a != report.culprit && contact.b != report.culprit) continue;
    text += fmt::format("; contact {} - {} at ({:.4f}, {:.4f}, {:.4f}), gap {:.3g} m, force {:.3g} N",
                        world.model.bodies[static_cast<std::size_t>(contact.a.index)].name,
                        world.model.bodies[static_cast<std::size_t>(contact.b.index)].name, contact.p_WQ.x(),
                        contact.p_WQ.y(), contact.p_WQ.z(), contact.phi, contact.force_W.norm());
  }
  return text;
}

}  // namespace snug::cell
