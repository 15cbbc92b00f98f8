// What states of a session do: the motion of a plan, and the next item while the tool leaves.
#include <algorithm>
#include <utility>

#include "snug/session/assessment.hpp"
#include "snug/session/internal/run.hpp"

namespace snug::session::internal {
namespace {

/// Attempts of an item that is planned anew on the way end at so many times RehearsalSettings::most_attempts.
constexpr int kMostPlannedAnew = 3;

/// The box met more than it should on the way to its place.
bool was_stopped_by_load(const Executor& executor) {
  const plant::End& end = executor.robot().end;
  const bool is_of_load = end.reason == plant::EndReason::ForceGuard || end.reason == plant::EndReason::VacuumLost ||
                          end.reason == plant::EndReason::HoldGuard || end.reason == plant::EndReason::ProtectiveStop;
  if (!is_of_load || !end.waypoint) return false;
  const motion::MotionClass at = executor.waypoints()[end.waypoint->slot()].motion_class;
  return at == motion::MotionClass::Place || at == motion::MotionClass::PlaceSlow;
}

/// A motion that met too much is not sent again; a way of turning boxes that did is not taken for others of their type.
void learn_from_end(Run& run) {
  const ItemTask& task = run.agenda.top();
  const plant::End& end = run.executor.robot().end;
  const bool would_again = end.reason == plant::EndReason::ForceGuard || end.reason == plant::EndReason::HoldGuard ||
                           end.reason == plant::EndReason::ProtectiveStop || end.reason == plant::EndReason::Timeout;
  if (!would_again || !end.waypoint) return;
  const planning::Attempt& attempt = *task.plan->best;
  const motion::MotionClass at = run.executor.waypoints()[end.waypoint->slot()].motion_class;
  const bool is_turning =
      at == motion::MotionClass::Twist || at == motion::MotionClass::TwistDrag || at == motion::MotionClass::PreTwist;
  const bool is_placing =
      at == motion::MotionClass::Place || at == motion::MotionClass::PlaceSlow || at == motion::MotionClass::PrePlace;
  if (!is_placing && !(is_turning && end.reason == plant::EndReason::ForceGuard)) return;
  run.belief.edit().failed.push_back({task.item, attempt.planned, attempt.skill, attempt.reorientation, is_turning});
}

/// One observation that shows nothing unexpected is believed. False: it is perceived again when the tool stands.
bool perceive_plainly(Run& run, model::ItemIndex own) {
  const perception::Observation seen = run.executor.perceive(run.belief.expectations());
  const bool is_plain =
      seen.fault == perception::LookFault::None && seen.missing.empty() && !run.belief.has_new_obstacle(seen);
  if (is_plain) believe(run, seen, own);
  return is_plain;
}

bool is_last_stage(const ItemTask& task) { return task.stage == task.plan->best->stages.size(); }

}  // namespace

Signal send_motion(Run& run) {
  ItemTask& task = run.agenda.top();
  const planning::Attempt& attempt = *task.plan->best;
  if (task.stage == 0) {
    run.agenda.pressed.erase(task.item);
    task.before = run.scene().believed_poses();
    auto& sent = run.belief.edit().sent;
    if (std::ranges::find(sent, task.item) == sent.end()) sent.push_back(task.item);
    run.log(
        event::Sent{run.executor.time(), task.item, task.plan->predicted_success, attempt.planned, task.replaces_last});
    task.sends += task.replaces_last ? 0 : 1;
    task.replaces_last = false;
  }
  const auto& all = attempt.program.waypoints;
  const std::size_t begin = task.stage == 0 ? 0 : attempt.stages[task.stage - 1];
  const std::size_t end = is_last_stage(task) ? all.size() : attempt.stages[task.stage];
  MotionOrder order{task.item, task.id, {}, {run.cell.limits.force, true, run.cell.limits.hold_guard}, std::nullopt};
  order.waypoints.assign(all.begin() + static_cast<std::ptrdiff_t>(begin),
                         all.begin() + static_cast<std::ptrdiff_t>(end));
  if (is_last_stage(task)) {
    run.belief.expect(attempt.ends);
    if (attempt.leaves) order.leaves = motion::WaypointIndex(*attempt.leaves - begin);
  } else {
    run.belief.expect_on_the_way(task.item, attempt.stage_poses[task.stage]);
  }
  run.executor.start(std::move(order));
  return Signal::Started;
}

Signal follow_motion(Run& run) {
  return run.executor.advance() == Executor::Pass::ToolLeaves ? Signal::ToolLeaves : Signal::MotionEnded;
}

Signal look_ahead(Run& run) {
  const ItemTask& task = run.agenda.top();
  const auto next = run.agenda.follower_of(task.item);
  if (!next || task.aside || (run.options.is_interrupted && run.options.is_interrupted())) return Signal::Finished;
  // A box that is taken out goes to the aligner: nothing may stand there.
  if (run.desk.wants_out(run.belief.now().items[next->slot()].id)) return Signal::Finished;
  const planning::Attempt& attempt = *task.plan->best;
  if (!perceive_plainly(run, task.item) || assess_item(run, attempt.planned) != Trouble::None) return Signal::Finished;
  planning::BeliefSnapshot& belief = run.belief.edit();
  if (!run.executor.bring(*next, belief.items[next->slot()].id, true)) return Signal::Finished;
  run.belief.weigh(task.item);
  run.belief.arrives(*next);
  run.decisions.bring_ahead(*next);
  if (!perceive_plainly(run, *next)) return Signal::Finished;
  run.decisions.see_ahead();
  if (!run.belief.box(*next)) return Signal::Finished;
  if (run.scene().size_error(*next) > belief.scenario.recovery.wrong_size) return Signal::Finished;
  belief.robot = {attempt.program.waypoints.back().X_WE, attempt.q_end, {}};
  belief.next = run.agenda.follower_of(*next);
  run.decisions.decide_ahead(belief, run.executor.read().time);
  return Signal::Finished;
}

Signal end_motion(Run& run) {
  ItemTask& task = run.agenda.top();
  if (const auto dropped = run.decisions.end_ahead(run.executor.robot())) {
    run.log(event::PlanDropped{run.executor.time(), dropped->plan.item, dropped->waited});
  }
  if (was_stopped_by_load(run.executor)) run.belief.stiffen();
  learn_from_end(run);
  if (run.executor.has_completed() && !is_last_stage(task)) return Signal::StageEnded;
  run.log(event::SendEnded{task.item, run.executor.robot().end});
  task.recovery = {};
  if (!run.executor.has_completed() || !run.decisions.has_ahead()) return Signal::ToBeAssessed;
  end_item(task, ItemEnd::Placed, {});
  return Signal::InPlace;
}

Signal perceive_stage(Run& run) {
  ItemTask& task = run.agenda.top();
  const model::Scenario& rules = run.belief.now().scenario;
  perceive(run, true);
  const auto& box = run.belief.box(task.item);
  const Pose& rehearsed = task.plan->best->stage_poses[task.stage];
  const bool is_off = box && box->was_seen &&
                      ((box->X_WP.p - rehearsed.p).norm() > rules.recovery.as_rehearsed + planning::slack_of(*box) ||
                       angle_between(box->X_WP.R, rehearsed.R) > rules.recovery.turned_as_rehearsed);
  if (!is_off) {
    ++task.stage;
    return Signal::AsRehearsed;
  }
  // Planned anew from where the box stands: the loop closed, nothing went wrong.
  run.log(event::SendEnded{task.item, run.executor.robot().end});
  task.replaces_last = true;
  if (task.attempts < kMostPlannedAnew * rules.rehearsal.most_attempts) return Signal::NotAsRehearsed;
  leave(run);
  task.reason = "it does not stand as in the rehearsal";
  return Signal::RoundsUsedUp;
}

}  // namespace snug::session::internal
