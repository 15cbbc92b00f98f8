// plan: where an item goes and by which motion, as a function of what is believed.
#include "snug/planning/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/core/hash.hpp"
#include "snug/core/stopwatch.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/planning/candidate_cost.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::planning {
namespace {

using Clock = std::chrono::steady_clock;

/// Percent: a utility that is larger by less is none.
constexpr double kSameUtility = 1e-9;

constexpr std::size_t kMostFree = 6;  ///< places that are tried where all others failed

/// In the end, when the item stays where it lies in the container; nothing: the agent does not know, or it may not.
std::optional<double> expected_percent(const Scene& scene, model::ItemIndex item, packing::Agent& agent) {
  if (scene.locate(item) != Location::Container || !scene.fit_of(item).is_in) return std::nullopt;
  return agent.expected_percent(scene.container_state());
}

class Planner {
 public:
  Planner(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget, PlanningWorkspace& work)
      : belief_(belief),
        budget_(budget),
        work_(work),
        scene_{belief_, work.cell_of(belief)},
        agent_(work.agent_for(belief, item, budget)) {
    plan_.item = item;
    plan_.standing = belief_.items[item.slot()] = scene_.item_as_it_stands(item);
    standing_ = {item, scene_.X_WP(item), scene_.locate(item)};
  }

  Plan make() {
    if (is_too_heavy()) return std::move(plan_);
    auto start = Clock::now();
    const packing::ContainerState state = scene_.container_state(plan_.item);
    const std::optional<double> here = expected_percent(scene_, plan_.item, agent_);
    least_utility_ = here ? *here + scene_.rules().recovery.gain_elsewhere : 0.0;
    const packing::PlaceCost cost = [&](const packing::Placement& one) { return cost_of(scene_, standing_, one); };
    auto decision = agent_.decide_with_costs(state, plan_.standing, cost);
    if (!decision) {
      plan_.decision_seconds += seconds_since(start);
      plan_.outcome = packing::is_infeasible(decision.error()) ? PlanOutcome::Infeasible : PlanOutcome::NoPlace;
      plan_.reason = packing::describe(decision.error());
      return std::move(plan_);
    }
    sort_by_utility(scene_, standing_, decision->candidates);
    X_WE_after_ = tool_after(packing::with_candidate(state, plan_.standing, decision->candidates.front()));
    plan_.decision_seconds += seconds_since(start);
    rehearse(decision->candidates);
    for (double pressed = decision->pressed; !plan_.best;) {
      start = Clock::now();
      auto more = agent_.decide_pressed(state, plan_.standing, cost, pressed);
      if (more) sort_by_utility(scene_, standing_, more->candidates);
      plan_.decision_seconds += seconds_since(start);
      if (!more) break;
      rehearse(more->candidates);
      pressed = more->pressed;
    }
    finish();
    return std::move(plan_);
  }

 private:
  /// Hanging still the cup could not carry it as often as it has to. What is too heavy for the robot is the agent's.
  bool is_too_heavy() {
    const skills::PlannedBox box = scene_.planned_box(plan_.item);
    const double factor = skills::still_hold_factor(belief_.nominal(), box), asked = scene_.cell.limits.hold_factor;
    if (factor >= asked || box.inertia.mass > scene_.rules().packing.max_item_mass) return false;
    const model::CupParams& cup = belief_.nominal().cup;
    const double area = asked / std::max(factor, 1e-3);  // what it carries goes with pressure times area
    const double pressure = cup.vacuum.pressure_gauge_hold * area;
    std::string would =
        fmt::format("a disc of {:.0f} mm (cup.effective_diameter)", 1e3 * cup.effective_diameter * std::sqrt(area));
    if (pressure > -cup.vacuum.ambient_pressure_abs) {
      would += fmt::format(" or {:.0f} kPa (cup.vacuum.pressure_gauge_hold)", 1e-3 * pressure);
    }
    plan_.outcome = PlanOutcome::Infeasible;
    plan_.reason = fmt::format(
        "too heavy for the cup: it could hold {:.2f} times the weight, {:.2f} times are required "
        "(place_limits.hold_factor); {} would hold it",
        factor, asked, would);
    return true;
  }

  /// Where the tool goes when the item is at its place: there the next one, as it is expected, would be picked if the
  /// container were `state` then. None: it stays over the box.
  std::optional<Pose> tool_after(const packing::ContainerState& state) {
    if (!belief_.next || !scene_.cell.layout.is_fast) return std::nullopt;
    const model::ItemIndex next = *belief_.next;
    const Pose X_WP = scene_.arrival_of(next);
    if (!belief_.agent.is_asked) {  // others are asked of what is, not of what is expected
      const StandingBox box{next, X_WP, Location::Aligner};
      const packing::PlaceCost cost = [&](const packing::Placement& one) { return cost_of(scene_, box, one); };
      auto decision =
          work_.agent_for(belief_, next, budget_).decide_with_costs(state, belief_.items[next.slot()], cost);
      if (decision) {
        sort_by_utility(scene_, box, decision->candidates);
        const auto outline = outline_of(scene_, box, decision->candidates.front().placement.orientation, plan_.item);
        if (outline) return outline->X_WE;
      }
    }
    return skills::tool_before_pick(belief_.nominal(), scene_.cell.layout, scene_.planned_box(next), X_WP,
                                    scene_.travel_bottom(plan_.item));
  }

  [[nodiscard]] bool is_enough(int attempts) const {
    const settings::RehearsalSettings& settings = scene_.rules().rehearsal;
    const double rate = plan_.best ? plan_.best->success_rate : -1.0;
    return rate >= settings.accepted_rate || attempts >= settings.most_attempts ||
           (attempts >= settings.max_attempts && rate >= settings.good_rate);
  }

  Tried& note(const packing::Candidate& candidate, double cost, Verdict verdict) {
    Tried& one = plan_.tried.emplace_back();
    one.planned = candidate.placement;
    one.expected_percent = candidate.expected_percent;
    one.cost = cost;
    one.utility = utility_of(scene_, candidate, 1.0, cost);
    one.verdict = verdict;
    return one;
  }

  /// Candidates in the order in which they are tried; the best of them all.
  void rehearse(const std::vector<packing::Candidate>& candidates) {
    const auto start = Clock::now();
    if (!rehearsal_) {  // once: what a grasp showed is not tried again for places that are found later
      rehearsal_.emplace(belief_, scene_.cell, work_.rollouts().take_up(belief_, budget_.threads), budget_.threads,
                         RehearsalTask{plan_.item, standing_.X_WP, standing_.location, X_WE_after_});
    }
    best_utility_ = least_utility_;
    const int before = plan_.attempts;
    bool has_ended = false, cannot_win = false;
    std::vector<const packing::Candidate*> untried;
    for (const packing::Candidate& candidate : candidates) {
      if (has_ended) {
        if (!cannot_win && !plan_.best && stands_free(candidate)) untried.push_back(&candidate);
        note(candidate, 0.0, cannot_win ? Verdict::CannotWin : Verdict::SearchEnded);
        continue;
      }
      const double cost = cost_of(scene_, standing_, candidate.placement);
      cannot_win = best_utility_ >= utility_of(scene_, candidate, 1.0, cost);
      if (cannot_win) {
        has_ended = true;
        note(candidate, cost, Verdict::CannotWin);
        continue;
      }
      try_insertions(candidate, cost, before);
      has_ended = is_enough(plan_.attempts - before);
    }
    // Nothing is left out while there is room for it: where the best places all failed, those where nothing is beside
    // it.
    for (std::size_t i = 0; i < untried.size() && i < kMostFree && !plan_.best; ++i) {
      try_insertions(*untried[i], cost_of(scene_, standing_, untried[i]->placement), plan_.attempts);
    }
    if (plan_.best && plan_.best->success_rate < scene_.rules().rehearsal.least_rate) {
      plan_.tried[best_].verdict = Verdict::TooRarely;
      plan_.best.reset();
    }
    plan_.rehearsal_seconds += seconds_since(start);
  }

  /// A box that is carried more slowly than others is pushed while its support carries it: where a push beside its
  /// weight is too much for the cup only so, else where the other ways failed.
  std::vector<skills::Insertion> insertions_for(const packing::Candidate& placed, const skills::PlannedBox& box) const {
    const model::Scenario& nominal = belief_.nominal();
    const settings::InsertionParams& params = scene_.rules().skills.insertion;
    std::vector<skills::Insertion> insertions = skills::choose_insertions(placed, box.size, params);
    const Vector3 up_P = placed.placement.X_TP.R.row(2).transpose();
    if (!scene_.cell.layout.is_fast || skills::pace_of(nominal, box, up_P) >= 1.0) return insertions;
    if (!skills::may_push_hanging(nominal, box, up_P)) insertions.clear();
    for (const skills::Insertion& one : skills::choose_insertions_on_support(placed, params)) insertions.push_back(one);
    return insertions;
  }

  void try_insertions(const packing::Candidate& candidate, double cost, int before) {
    const settings::InsertionParams& params = scene_.rules().skills.insertion;
    const packing::Candidate placed = skills::measured(scene_.container_state(plan_.item), candidate,
                                                       plan_.standing.size, belief_.nominal().parcel_clearance, params);
    for (const skills::Insertion& insertion : insertions_for(placed, rehearsal_->box())) {
      if (is_enough(plan_.attempts - before)) return;
      Attempt attempt = rehearsal_->attempt(placed, insertion, scene_.packed_top(plan_.item));
      if (attempt.failure == AttemptFailure::SentBefore) {
        note(placed, cost, Verdict::SentBefore).reason = attempt.text;
        continue;
      }
      if (!attempt.was_rehearsed) {
        note(placed, cost, Verdict::GraspKnown).reason = attempt.text;
        return;
      }
      take(std::move(attempt), placed, cost);
    }
  }

  void take(Attempt attempt, const packing::Candidate& placed, double cost) {
    Tried& one = note(placed, cost, attempt.succeeded ? Verdict::LessUtility : Verdict::Failed);
    one.planned = attempt.planned;
    one.skill = attempt.skill;
    one.failure = attempt.failure;
    one.succeeded = attempt.succeeded;
    one.samples = attempt.samples;
    one.success_rate = attempt.success_rate;
    one.reason = attempt.text;
    plan_.attempts += 1;
    plan_.stops += attempt.was_stopped ? 1 : 0;
    if (plan_.reason.empty()) plan_.reason = attempt.text;
    if (!attempt.succeeded) return;
    one.utility = utility_of(scene_, placed, attempt.success_rate, cost);
    if (one.utility <= best_utility_ + kSameUtility) return;
    best_utility_ = one.utility;
    if (plan_.best) plan_.tried[best_].verdict = Verdict::LessUtility;
    best_ = plan_.tried.size() - 1;
    one.verdict = Verdict::Best;
    plan_.best = std::move(attempt);
  }

  void finish() {
    if (!plan_.best) {
      plan_.outcome = PlanOutcome::NoPlace;
      if (plan_.reason.empty()) plan_.reason = "no place where it would come to rest as planned";
      return;
    }
    const Attempt& best = *plan_.best;
    const settings::RehearsalSettings& settings = scene_.rules().rehearsal;
    plan_.outcome = PlanOutcome::Found;
    plan_.reason.clear();
    plan_.box = scene_.planned_box(plan_.item);
    plan_.flips = packing::count_flips(plan_.standing.arrival, best.planned.orientation);
    plan_.predicted_success = (best.success_rate * best.samples + settings.prior_rate * settings.prior_count) /
                              (best.samples + settings.prior_count);
  }

  BeliefSnapshot belief_;
  const Budget& budget_;
  PlanningWorkspace& work_;
  Scene scene_;
  packing::Agent& agent_;
  StandingBox standing_;
  std::optional<Pose> X_WE_after_;
  std::optional<Rehearsal> rehearsal_;
  double least_utility_ = 0.0, best_utility_ = 0.0;
  std::size_t best_ = 0;  ///< of Plan::tried, where there is a best
  Plan plan_;
};

void add(Hash& hash, const Pose& X) {
  for (const double value : X.R.reshaped()) hash.add(value);
  for (const double value : X.p) hash.add(value);
}

void add(Hash& hash, const packing::Placement& placement) {
  hash.add(placement.item);
  add(hash, placement.X_TP);
  hash.add(static_cast<std::uint64_t>(placement.flips));
}

}  // namespace

const char* name_of(PlanOutcome outcome) {
  switch (outcome) {
    case PlanOutcome::Found:
      return "found";
    case PlanOutcome::NoPlace:
      return "no place";
    case PlanOutcome::Infeasible:
      return "infeasible";
  }
  return "";
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::Best:
      return "best";
    case Verdict::LessUtility:
      return "less utility";
    case Verdict::TooRarely:
      return "too rarely";
    case Verdict::Failed:
      return "failed";
    case Verdict::SentBefore:
      return "sent before";
    case Verdict::GraspKnown:
      return "cannot be held so";
    case Verdict::CannotWin:
      return "cannot win";
    case Verdict::SearchEnded:
      return "search ended";
  }
  return "";
}

Plan plan(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget, PlanningWorkspace& work) {
  return Planner(belief, item, budget, work).make();
}

Plan plan(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget) {
  PlanningWorkspace work;
  return plan(belief, item, budget, work);
}

double gain_elsewhere(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                      PlanningWorkspace& work) {
  const Scene scene{belief, work.cell_of(belief)};
  packing::Agent& agent = work.agent_for(belief, item, budget);
  const std::optional<double> here = expected_percent(scene, item, agent);
  if (!here) return 0.0;
  const auto decision = agent.decide(scene.container_state(item), scene.item_as_it_stands(item));
  return decision ? decision->candidates.front().expected_percent - *here : 0.0;
}

std::uint64_t hash(const Plan& plan) {
  Hash hash;
  hash.add(static_cast<std::uint64_t>(plan.item.value));
  hash.add(std::string_view(name_of(plan.outcome)));
  hash.add(plan.reason);
  for (const Tried& one : plan.tried) {
    add(hash, one.planned);
    hash.add(std::string_view(name_of(one.verdict)));
    for (const double value : {one.expected_percent, one.cost, one.utility, one.success_rate}) hash.add(value);
    hash.add(one.reason);
  }
  if (!plan.best) return hash.value();
  const Attempt& best = *plan.best;
  add(hash, best.planned);
  hash.add(motion::format_program(best.program));
  for (const double value : {best.predicted.force, best.predicted.torque, best.predicted.displacement}) hash.add(value);
  for (const auto& world : best.ends) {
    for (const std::optional<Pose>& one : world) {
      if (one) add(hash, *one);
    }
  }
  return hash.value();
}

}  // namespace snug::planning
