// plan: where an item goes and by which motion, as a function of what is believed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "snug/planning/rehearsal.hpp"
#include "snug/planning/workspace.hpp"

namespace snug::planning {

enum class PlanOutcome {
  Found,
  NoPlace,     ///< nothing was found that would come to rest as planned
  Infeasible,  ///< it would not fit into the empty container either, is too heavy or cannot be held
};
[[nodiscard]] const char* name_of(PlanOutcome outcome);

/// What became of one candidate, with one insertion where it was tried.
enum class Verdict {
  Best,         ///< this one is sent
  LessUtility,  ///< it succeeded, another one is worth more
  TooRarely,    ///< best, but in fewer samples than `rehearsal.least_rate`
  Failed,       ///< in the nominal world
  SentBefore,   ///< not tried: it was sent, and ended by what it met
  GraspKnown,   ///< not tried: the box cannot be held so, as an attempt before showed
  CannotWin,    ///< not tried: were it certain, it would not be worth more than the best
  SearchEnded,  ///< not tried: the best is good enough, or too many were tried
};
[[nodiscard]] const char* name_of(Verdict verdict);

struct Tried {
  packing::Placement planned;
  double expected_percent = 0.0;  ///< as the agent says; 0: it does not
  double cost = 0.0;              ///< percent, of turning the box
  double utility = 0.0;           ///< percent; where it was not tried or failed: as if it were certain
  Verdict verdict = Verdict::SearchEnded;
  skills::InsertionSkill skill = skills::InsertionSkill::TopDown;  ///< where it was tried
  AttemptFailure failure = AttemptFailure::None;  ///< in the nominal world, else of the first sample that failed
  bool succeeded = false;                         ///< in the nominal world
  int samples = 0;                                ///< that were rehearsed
  double success_rate = 0.0;                      ///< of these, by weight
  std::string reason;                             ///< why it failed, for people
  bool operator==(const Tried&) const = default;
  [[nodiscard]] bool was_rehearsed() const {
    return verdict != Verdict::SentBefore && verdict != Verdict::GraspKnown && verdict != Verdict::CannotWin &&
           verdict != Verdict::SearchEnded;
  }
};

struct Plan {
  model::ItemIndex item;
  packing::Item standing;  ///< the item as it stands
  PlanOutcome outcome = PlanOutcome::NoPlace;
  std::string reason;        ///< for people; empty where a motion was found
  std::vector<Tried> tried;  ///< in their order
  int attempts = 0;          ///< that were rehearsed
  int stops = 0;             ///< of these, ended by a protective stop of the robot in the nominal world
  std::optional<Attempt> best;
  skills::PlannedBox box;          ///< where a motion was found
  int flips = 0;                   ///< quarter turns over an edge that it needs
  double predicted_success = 0.0;  ///< what is expected of the motion: samples, and what is expected before any
  double decision_seconds = 0.0;   ///< wall clock, of the agent alone; no part of the decision
  double rehearsal_seconds = 0.0;  ///< the same of rollouts
};

/// Where the item goes from where it is believed to be, and the motion that brings it there. The same belief, item and
/// decision time: the same plan, whatever the threads and whatever `work` was used for. The item is in the cell.
/// Throws InputError as PlanningWorkspace does.
[[nodiscard]] Plan plan(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                        PlanningWorkspace& work);
[[nodiscard]] Plan plan(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget);

/// Percent of the container that is expected more with the item in the best other place than where it lies now; 0 where
/// the agent does not know.
[[nodiscard]] double gain_elsewhere(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                                    PlanningWorkspace& work);

/// Of all that is decided: equal decisions, equal hashes; wall clock does not count.
[[nodiscard]] std::uint64_t hash(const Plan& plan);

}  // namespace snug::planning
