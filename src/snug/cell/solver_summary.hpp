// SolverSummary: how well the contact solver did over a run, and which bodies were deeper in each other than they may.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/cell/failure.hpp"
#include "snug/cell/world_builder.hpp"
#include "snug/record/recording.hpp"

namespace snug::cell {

enum class ContactLimit { RigidDepth, CompliantDepth, Residual };

/// Two bodies whose contact passed a limit of model::ContactLimits.
struct PassedLimit {
  ContactLimit limit = ContactLimit::RigidDepth;
  std::string body_a, body_b;
  double allowed = 0.0;     ///< m, or m/s of a residual
  double worst = 0.0;       ///< the same
  double worst_time = 0.0;  ///< s
  double since = 0.0;       ///< s, when it was first passed
};

struct SolverSummary {
  std::int64_t steps = 0;
  std::int64_t not_converged = 0;
  std::int64_t infeasible = 0;             ///< of these: nothing could keep rigid bodies apart
  double infeasible_time = 0.0;            ///< s, of the first
  std::string infeasible_a, infeasible_b;  ///< bodies of its worst contact
  double worst_residual = 0.0;             ///< m/s
  double worst_penetration = 0.0;          ///< m, rigid contacts
  double worst_compliant_depth = 0.0;      ///< m, compliant contacts
  double mean_sweeps = 0.0;                ///< over steps with contacts
  std::vector<PassedLimit> passed;         ///< in the order in which it happened, one for each limit and pair
};

/// Gathers a SolverSummary step by step.
class SolverMonitor {
 public:
  explicit SolverMonitor(const model::ContactLimits& limits = {}) : limits_(limits) {}
  /// `time`: s, at the end of the step that the report is of.
  void add(const physics::StepReport& report, double time);
  [[nodiscard]] SolverSummary summary(const CellWorld& world) const;
  /// "deep contact" and "contact residual" of pairs that passed a limit since the last call.
  [[nodiscard]] std::vector<record::Event> take_events(const CellWorld& world);

 private:
  struct Passed {
    ContactLimit limit;
    physics::BodyPair pair;
    double worst, worst_time, since;
  };
  void check(ContactLimit limit, double value, const physics::BodyPair& pair, double time);
  [[nodiscard]] double allowed(ContactLimit limit) const;
  [[nodiscard]] PassedLimit named(const Passed& passed, const CellWorld& world) const;

  model::ContactLimits limits_;
  SolverSummary summary_;
  std::vector<Passed> passed_;
  std::size_t taken_ = 0;
  physics::BodyPair infeasible_;
  std::int64_t sweeps_ = 0;
  std::int64_t steps_with_contacts_ = 0;
};

/// Why a run cannot go on after this step, if so: the body, the time and the last contacts.
[[nodiscard]] Failure find_failure(const CellWorld& world, const physics::WorldState& state,
                                   const physics::Workspace& work, const physics::StepReport& report);

/// Why a run that went on to its end failed all the same, if so: bodies too deep in each other, and what to change.
[[nodiscard]] Failure find_depth_failure(const SolverSummary& summary);
/// What a run's result is to be taken with: residuals over their limit.
[[nodiscard]] std::vector<std::string> describe_warnings(const SolverSummary& summary);

}  // namespace snug::cell
