// SolverSummary: how well the contact solver did over a run, and which bodies were deeper in each other than they may.
#include "snug/cell/solver_summary.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace snug::cell {

namespace {

constexpr std::size_t kMostPassed = 64;  ///< pairs; a run in which more fail is told by these

double worst_over_allowed(const PassedLimit& passed) { return passed.worst / passed.allowed; }

const char* remedy_of(ContactLimit limit) {
  if (limit == ContactLimit::RigidDepth) {
    return "the body that presses them is kinematic, so nothing holds it back, or it is too heavy or fast for the time "
           "step: end its path earlier, or use a smaller time_step or more similar masses";
  }
  return "a stiffer pair (contacts), more damping, a lower speed or a lighter body keeps them apart; a contact deeper "
         "than half a wall pushes the body out on the other side";
}

std::string name_of(physics::BodyId id, const CellWorld& world) {
  return id.is_valid() ? world.model.bodies[static_cast<std::size_t>(id.index)].name : std::string("?");
}

}  // namespace

double SolverMonitor::allowed(ContactLimit limit) const {
  if (limit == ContactLimit::Residual) return limits_.residual;
  return limit == ContactLimit::RigidDepth ? limits_.rigid_depth : limits_.compliant_depth;
}

void SolverMonitor::check(ContactLimit limit, double value, const physics::BodyPair& pair, double time) {
  if (!(value > allowed(limit))) return;
  const auto known =
      std::find_if(passed_.begin(), passed_.end(), [&](const Passed& p) { return p.limit == limit && p.pair == pair; });
  if (known == passed_.end()) {
    if (passed_.size() < kMostPassed) passed_.push_back({limit, pair, value, time, time});
  } else if (value > known->worst) {
    known->worst = value;
    known->worst_time = time;
  }
}

void SolverMonitor::add(const physics::StepReport& report, double time) {
  ++summary_.steps;
  summary_.worst_residual = std::max(summary_.worst_residual, report.residual);
  summary_.worst_penetration = std::max(summary_.worst_penetration, report.worst_penetration);
  summary_.worst_compliant_depth = std::max(summary_.worst_compliant_depth, report.worst_compliant_depth);
  check(ContactLimit::RigidDepth, report.worst_penetration, report.worst_penetration_pair, time);
  check(ContactLimit::CompliantDepth, report.worst_compliant_depth, report.worst_compliant_pair, time);
  if (report.status == physics::StepStatus::NotConverged) {
    ++summary_.not_converged;
    if (report.is_infeasible && summary_.infeasible++ == 0) {
      summary_.infeasible_time = time;
      infeasible_ = report.residual_pair;
    }
    check(ContactLimit::Residual, report.residual, report.residual_pair, time);
  }
  if (report.contacts == 0) return;
  ++steps_with_contacts_;
  sweeps_ += report.sweeps;
}

PassedLimit SolverMonitor::named(const Passed& passed, const CellWorld& world) const {
  return {passed.limit,
          name_of(passed.pair.a, world),
          name_of(passed.pair.b, world),
          allowed(passed.limit),
          passed.worst,
          passed.worst_time,
          passed.since};
}

SolverSummary SolverMonitor::summary(const CellWorld& world) const {
  SolverSummary summary = summary_;
  if (steps_with_contacts_ > 0) {
    summary.mean_sweeps = static_cast<double>(sweeps_) / static_cast<double>(steps_with_contacts_);
  }
  for (const Passed& passed : passed_) summary.passed.push_back(named(passed, world));
  summary.infeasible_a = name_of(infeasible_.a, world);
  summary.infeasible_b = name_of(infeasible_.b, world);
  return summary;
}

std::vector<record::Event> SolverMonitor::take_events(const CellWorld& world) {
  std::vector<record::Event> events;
  for (; taken_ < passed_.size(); ++taken_) {
    const PassedLimit passed = named(passed_[taken_], world);
    if (passed.limit == ContactLimit::Residual) {
      events.push_back({passed.since,
                        "contact residual",
                        passed.body_a,
                        fmt::format("contact with '{}' is not solved", passed.body_b),
                        {{"residual_m_s", passed.worst}, {"limit_m_s", passed.allowed}}});
    } else {
      events.push_back({passed.since,
                        "deep contact",
                        passed.body_a,
                        fmt::format("too deep in '{}'", passed.body_b),
                        {{"depth_mm", 1e3 * passed.worst}, {"limit_mm", 1e3 * passed.allowed}}});
    }
  }
  return events;
}

Failure find_depth_failure(const SolverSummary& summary) {
  const PassedLimit* worst = nullptr;
  std::size_t pairs = 0;
  for (const PassedLimit& passed : summary.passed) {
    if (passed.limit == ContactLimit::Residual) continue;
    ++pairs;
    if (worst == nullptr || worst_over_allowed(passed) > worst_over_allowed(*worst)) worst = &passed;
  }
  if (worst == nullptr) return {};
  const bool is_rigid = worst->limit == ContactLimit::RigidDepth;
  std::string text = fmt::format(
      "{} bodies '{}' and '{}' were {:.1f} mm deep in each other at t = {:.3f} s (beyond {:.3g} mm since t = {:.3f} s",
      is_rigid ? "rigid" : "compliant", worst->body_a, worst->body_b, 1e3 * worst->worst, worst->worst_time,
      1e3 * worst->allowed, worst->since);
  if (pairs > 1) text += fmt::format("; {} other pair{} too", pairs - 1, pairs == 2 ? "" : "s");
  return {FailureKind::ContactDepth,
          text + fmt::format("): {} (limit: solver.contact_limits.{})", remedy_of(worst->limit),
                             is_rigid ? "rigid_depth" : "compliant_depth")};
}

std::vector<std::string> describe_warnings(const SolverSummary& summary) {
  std::vector<std::string> warnings;
  if (summary.infeasible > 0) {
    warnings.push_back(fmt::format(
        "{} of {} steps had no solution, the first at t = {:.3f} s between '{}' and '{}': a body on a given "
        "path presses rigid ones together; end its path earlier or make a pair compliant (contacts: stiffness)",
        summary.infeasible, summary.steps, summary.infeasible_time, summary.infeasible_a, summary.infeasible_b));
  }
  const PassedLimit* worst = nullptr;
  for (const PassedLimit& passed : summary.passed) {
    if (passed.limit != ContactLimit::Residual) continue;
    if (worst == nullptr || passed.worst > worst->worst) worst = &passed;
  }
  if (worst == nullptr) return warnings;
  warnings.push_back(
      fmt::format("{} of {} steps were not solved; worst: {:.2g} m/s at t = {:.3f} s between '{}' and '{}': forces and "
                  "motions of these steps are inaccurate; a smaller time_step or more similar masses help (limit: "
                  "solver.contact_limits.residual, {:.3g} m/s)",
                  summary.not_converged, summary.steps, worst->worst, worst->worst_time, worst->body_a, worst->body_b,
                  worst->allowed));
  return warnings;
}

Failure find_failure(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                     const physics::StepReport& report) {
  if (report.status == physics::StepStatus::Converged || report.status == physics::StepStatus::NotConverged) return {};
  if (report.status == physics::StepStatus::TooManyPairs) {
    return {FailureKind::TooManyPairs,
            fmt::format("t = {:.3f} s: too many pairs of bodies are near each other", state.time(world.model))};
  }
  const bool is_finite = report.status != physics::StepStatus::NotFinite;
  std::string text = fmt::format("t = {:.3f} s: {} of body '{}'", state.time(world.model),
                                 is_finite ? "lost track" : "the state is not a number any more",
                                 world.model.bodies[static_cast<std::size_t>(report.culprit.index)].name);
  for (const physics::ContactReport& contact : work.contacts()) {
    if (contact.a != report.culprit && contact.b != report.culprit) continue;
    text += fmt::format("; contact {} - {} at ({:.4f}, {:.4f}, {:.4f}), gap {:.3g} m, force {:.3g} N",
                        world.model.bodies[static_cast<std::size_t>(contact.a.index)].name,
                        world.model.bodies[static_cast<std::size_t>(contact.b.index)].name, contact.p_WQ.x(),
                        contact.p_WQ.y(), contact.p_WQ.z(), contact.phi, contact.force_W.norm());
  }
  return {is_finite ? FailureKind::LostBody : FailureKind::NotFinite, std::move(text)};
}

}  // namespace snug::cell
