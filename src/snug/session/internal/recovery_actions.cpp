// What states of a session do: troubles of a motion, and what is done about them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "snug/session/assessment.hpp"
#include "snug/session/internal/run.hpp"
#include "snug/session/remedy_motions.hpp"

namespace snug::session::internal {
namespace {

/// Boxes under way at once: the item that came, one that it moved, one that this one moved.
constexpr std::size_t kMostUnderWay = 3;
constexpr int kMostReturns = 2;            ///< for one motion: the first may push a box that leans over
constexpr double kGainWorthSaying = 0.05;  ///< percent

Trouble find_trouble(Run& run) {
  const ItemTask& task = run.agenda.top();
  const Trouble ended = trouble_of(run.executor.robot().end.reason);
  const bool lost_hold = ended == Trouble::NoSeal || ended == Trouble::VacuumLost;
  if (ended != Trouble::None && !lost_hold) return ended;
  if (lost_hold) retreat(run, task.item);
  perceive(run);
  const Trouble seen = assess_item(run, task.plan->best->planned);
  return lost_hold ? ended : seen;
}

/// It may be another box that sticks out or was moved: then that is pressed, or taken out and packed anew.
model::ItemIndex find_culprit(const Run& run) {
  const ItemTask& task = run.agenda.top();
  std::optional<model::ItemIndex> culprit;
  if (task.recovery.trouble == Trouble::SticksOut) culprit = find_sticking_out(run.scene(), run.agenda, task.item);
  if (task.recovery.trouble == Trouble::NeighbourMoved) {
    culprit = find_moved(run.scene(), run.agenda, task.item, task.before);
  }
  return culprit.value_or(task.item);
}

Situation situation_of(Run& run) {
  const ItemTask& task = run.agenda.top();
  const RecoveryTask& recovery = task.recovery;
  const planning::Scene scene = run.scene();
  const settings::RecoverySettings& settings = scene.rules().recovery;
  const model::ItemIndex culprit = recovery.culprit;
  const bool is_there = scene.box(culprit).has_value();
  Situation at;
  at.trouble = recovery.trouble;
  at.tries = task.sends;
  at.is_held = run.executor.is_holding();
  at.can_set_down = scene.cell.layout.flip_place.has_value();
  at.fits = is_there && scene.fit_of(culprit).is_in && !find_sticking_out(scene, run.agenda, culprit);
  at.leans = is_there && scene.locate(culprit) == planning::Location::Container &&
             scene.tilt_of(culprit) > scene.cell.limits.tilt;
  at.lies_turned = task.angle_error > settings.lies_turned;
  at.can_be_picked = scene.can_be_picked(culprit);
  if (at.fits && !at.is_held) at.gain_elsewhere = run.decisions.gain_elsewhere(run.belief.now(), culprit);
  if (culprit != task.item) {
    at.tries = run.agenda.under_way.size() < kMostUnderWay ? 1 + recovery.repacked : settings.most_tries;
    at.lies_on_others = was_lifted(scene, culprit, task.before);
  }
  at.stops = recovery.stops;
  at.can_return = recovery.returns < kMostReturns && !run.decisions.has_ahead() && is_aligner_free(scene, culprit) &&
                  (at.is_held || can_return(scene, culprit));
  at.was_pressed = recovery.was_pressed || (is_there && scene.is_under_obstacle(culprit));
  return at;
}

std::string detail_of(const Run& run, const Situation& at) {
  const ItemTask& task = run.agenda.top();
  const bool is_of_motion = trouble_of(run.executor.robot().end.reason) == at.trouble;
  std::string detail = is_of_motion ? run.executor.describe_end() : std::string();
  const model::ItemIndex culprit = task.recovery.culprit;
  if (culprit != task.item) detail = run.belief.now().items[culprit.slot()].id;
  if (at.gain_elsewhere > kGainWorthSaying) {
    detail += fmt::format("{}{:.1f} % more expected elsewhere", detail.empty() ? "" : ", ", at.gain_elsewhere);
  }
  return detail;
}

/// Recovery of a motion ends: worlds that predicted what it came to weigh more.
Signal recovered(Run& run, Signal signal) {
  if (run.executor.has_completed()) run.belief.weigh(run.agenda.top().item);
  return signal;
}

/// Another box stays where it lies now.
Signal leave_other(Run& run) {
  forget_displacement(run);
  return Signal::LeaveOther;
}

StopReason stop_reason_of(Trouble trouble) {
  return trouble == Trouble::PlantFault  ? StopReason::PlantFault
         : trouble == Trouble::Cancelled ? StopReason::Interrupted
                                         : StopReason::RobotStops;
}

Signal carry_out(Run& run, Remedy remedy) {
  ItemTask& task = run.agenda.top();
  RecoveryTask& recovery = task.recovery;
  const bool is_other = recovery.culprit != task.item;
  switch (remedy) {
    case Remedy::None:
    case Remedy::Accept:
      if (is_other) return leave_other(run);
      end_item(task, ItemEnd::Accepted, task.reason);
      return recovered(run, Signal::Accept);
    case Remedy::PickAgain:
      recovery.ends_unless_moved = true;
      return is_other ? Signal::RepackOther : recovered(run, Signal::PickAgain);
    case Remedy::Skip:
      run.agenda.left_out.insert(recovery.culprit);
      if (is_other) return leave_other(run);
      give_up(run, recovery.trouble);
      return recovered(run, Signal::Skip);
    case Remedy::Stop:
      stop(run, stop_reason_of(recovery.trouble));
      give_up(run, recovery.trouble);
      return recovered(run, Signal::Stop);
    case Remedy::Resume:
      return Signal::Resume;
    case Remedy::SetDown:
      return Signal::SetDown;
    case Remedy::Release:
      return Signal::Release;
    case Remedy::PressLevel:
      return Signal::PressLevel;
    case Remedy::ReturnToAligner:
      return Signal::ReturnToAligner;
    case Remedy::PerceiveAgain:
    case Remedy::MoveAway:
    case Remedy::Believe:  // of pictures: perceive()
      break;
  }
  return leave_other(run);
}

}  // namespace

Signal assess_motion(Run& run) {
  ItemTask& task = run.agenda.top();
  RecoveryTask& recovery = task.recovery;
  recovery.trouble = find_trouble(run);
  const bool is_fine = recovery.trouble == Trouble::None;
  const bool is_used_up = recovery.rounds >= run.belief.now().scenario.recovery.most_rounds;
  if (!is_fine && !is_used_up) {
    ++recovery.rounds;
    return Signal::Trouble;
  }
  if (is_fine || recovery.trouble == Trouble::NeighbourMoved) {
    end_item(task, ItemEnd::Placed, task.reason);
  } else {
    give_up(run, recovery.trouble);
  }
  return recovered(run, is_fine ? Signal::NoTrouble : Signal::RoundsUsedUp);
}

Signal choose(Run& run) {
  RecoveryTask& recovery = run.agenda.top().recovery;
  recovery.culprit = find_culprit(run);
  recovery.stops += recovery.trouble == Trouble::ProtectiveStop ? 1 : 0;
  const Situation at = situation_of(run);
  recovery.tries = at.tries;
  const Remedy remedy = choose_remedy(at, run.belief.now().scenario.recovery);
  note_remedy(run, recovery.trouble, remedy, detail_of(run, at), true);
  return carry_out(run, remedy);
}

Signal resume(Run& run) {
  const ItemTask& task = run.agenda.top();
  run.executor.acknowledge();
  const auto& last = run.executor.waypoints();
  const auto aimed_at = run.executor.robot().end.waypoint.value_or(motion::WaypointIndex());
  std::vector<motion::Waypoint> rest(last.begin() + aimed_at.value, last.end());
  run.executor.run(
      {task.item, task.id, std::move(rest), {run.cell.limits.force, true, run.cell.limits.hold_guard}, {}});
  return Signal::Finished;
}

Signal set_down(Run& run) {
  const ItemTask& task = run.agenda.top();
  const planning::Attempt& attempt = *task.plan->best;
  run.belief.doubt_prediction();
  run.belief.let_go(task.item);
  const Carried held{task.item, task.plan->box, run.cell.layout.X_WT.R * attempt.planned.X_TP.R, attempt.X_PS,
                     attempt.swing};
  run.executor.run({task.item, task.id, plan_to_bench(run.scene(), run.executor.robot(), held), {{}, true}, {}});
  if (!run.executor.has_completed()) return Signal::Finished;
  perceive(run);
  if (!run.scene().can_be_picked(task.item)) return Signal::Finished;
  return recovered(run, Signal::ToBePlannedAnew);
}

Signal release(Run& run) {
  retreat(run, run.agenda.top().item);
  return Signal::Finished;
}

Signal press_level(Run& run) {
  RecoveryTask& recovery = run.agenda.top().recovery;
  const model::ItemIndex culprit = recovery.culprit;
  recovery.was_pressed = true;
  press_on(run, culprit);
  return Signal::Finished;
}

Signal return_to_aligner(Run& run) {
  ItemTask& task = run.agenda.top();
  RecoveryTask& recovery = task.recovery;
  const model::ItemIndex culprit = recovery.culprit;
  const bool is_other = culprit != task.item;
  const auto is_there = [&] { return run.belief.box(culprit).has_value(); };
  const auto again = [&] {
    if (is_other) forget_displacement(run);
    return Signal::Finished;
  };
  ++recovery.returns;
  send_to_aligner(run, culprit, !is_other);
  if (!run.executor.has_completed()) return again();
  perceive(run);
  if (is_there() && run.scene().locate(culprit) != planning::Location::Aligner) return again();
  if (is_there() && recovery.tries < run.belief.now().scenario.recovery.most_tries) {
    recovery.ends_unless_moved = false;
    return is_other ? Signal::RepackOther : recovered(run, Signal::ToBePlannedAnew);
  }
  run.belief.forget(culprit);  // the next arrival takes it away
  if (is_other) {
    run.agenda.returned.insert(culprit);
    return again();
  }
  end_item(task, ItemEnd::Returned, name_of(recovery.trouble));
  return recovered(run, Signal::TakenAway);
}

}  // namespace snug::session::internal
