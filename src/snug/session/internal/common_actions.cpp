// What several states of a session have in common: perceiving, letting go, and words for what became of an item.
#include <algorithm>
#include <utility>

#include "snug/session/assessment.hpp"
#include "snug/session/internal/run.hpp"
#include "snug/session/remedy_motions.hpp"

namespace snug::session::internal {
namespace {

Trouble trouble_of(perception::LookFault fault) {
  switch (fault) {
    case perception::LookFault::None:
      return Trouble::None;
    case perception::LookFault::TooFewPoints:
      return Trouble::BadPicture;
    case perception::LookFault::ViewBlocked:
      return Trouble::ViewBlocked;
    case perception::LookFault::NoFrame:
      return Trouble::NoFrame;
  }
  return Trouble::None;
}

void stop_blind(Run& run, const perception::Observation& seen) {
  if (seen.fault != perception::LookFault::NoFrame) return stop(run, StopReason::ViewBlocked);
  stop(run, StopReason::NoFrame, std::string(name_of(StopReason::NoFrame)) + ": " + seen.trouble);
}

/// One that tells something, if there is any; troubles with that are in the log.
perception::Observation observe(Run& run, std::span<const perception::Expectation> expected, bool stays) {
  const settings::RecoverySettings& settings = run.belief.now().scenario.recovery;
  perception::Observation seen = run.executor.perceive(expected);
  Situation at;
  while (seen.fault != perception::LookFault::None && !run.stop) {
    at.trouble = trouble_of(seen.fault);
    at.is_held = stays || run.executor.is_holding();
    ++at.pictures;
    const Remedy remedy = choose_remedy(at, settings);
    note_remedy(run, at.trouble, remedy, seen.trouble, false);
    if (run.options.is_interrupted && run.options.is_interrupted()) stop(run, StopReason::Interrupted);
    if (remedy == Remedy::Stop) stop_blind(run, seen);
    if (run.stop || remedy == Remedy::Believe) break;
    if (remedy == Remedy::MoveAway) move_home(run);
    seen = run.executor.perceive(expected);
  }
  return seen;
}

}  // namespace

void believe(Run& run, const perception::Observation& seen, model::ItemIndex own) {
  const std::size_t known = run.belief.obstacles().reports().size();
  run.belief.see(seen);
  // It is not seen, and something that was not there stands higher over its place: that is the box, or lies on it.
  const bool has_news = run.belief.obstacles().reports().size() > known;
  const auto& box = run.belief.box(own);
  if (has_news && box && !box->was_seen && run.scene().is_under_obstacle(own)) run.belief.forget(own);
  run.belief.forget_let_go();
}

void perceive(Run& run, bool stays) {
  const std::vector<perception::Expectation> expected = run.belief.expectations();
  perception::Observation seen = observe(run, expected, stays);
  if (!seen.missing.empty() || run.belief.has_new_obstacle(seen)) {  // one picture may be bad
    const perception::Observation before = std::move(seen);
    seen = observe(run, expected, stays);
    std::erase_if(seen.missing,
                  [&](const std::string& id) { return std::ranges::find(before.missing, id) == before.missing.end(); });
    run.belief.drop_unconfirmed(seen, before);
  }
  believe(run, seen, run.agenda.top().item);
}

Trouble assess_item(Run& run, const packing::Placement& planned) {
  ItemTask& task = run.agenda.top();
  const Assessment now = assess(run.scene(), run.agenda, task.item, planned, task.before);
  if (!now.X_TP) return now.trouble;
  task.angle_error = now.angle_error;
  run.log(event::Assessed{run.executor.time(), task.item, *now.X_TP, now.position_error, now.angle_error,
                          now.displacement, now.trouble});
  return now.trouble;
}

void retreat(Run& run, model::ItemIndex item) {
  run.belief.doubt_prediction();
  const plant::Feedback& robot = run.executor.robot();
  if (run.executor.is_holding() || robot.end.reason == plant::EndReason::VacuumLost) run.belief.let_go(item);
  const std::string& id = run.belief.now().items[item.slot()].id;
  const std::vector<motion::Waypoint> waypoints = plan_retreat(run.scene(), robot, id);
  for (int stops = 0; stops <= run.belief.now().scenario.recovery.most_stops; ++stops) {
    run.executor.acknowledge();
    run.executor.run({item, id, waypoints, {std::nullopt, false}, {}});
    if (run.executor.robot().end.reason != plant::EndReason::ProtectiveStop) return;
  }
}

void press_on(Run& run, model::ItemIndex item) {
  run.agenda.pressed.insert(item);
  run.executor.run({item,
                    run.belief.now().items[item.slot()].id,
                    plan_press_on(run.scene(), item),
                    {run.belief.now().scenario.skills.press.force, false},
                    {}});
  // The force that ends a press is what was asked for.
  if (run.executor.robot().end.reason == plant::EndReason::ForceGuard) retreat(run, item);
}

void move_home(Run& run) {
  run.executor.run({{}, {}, plan_home(run.scene(), run.executor.robot()), {std::nullopt, false}, {}});
}

void send_to_aligner(Run& run, model::ItemIndex item, bool may_hang_as_planned) {
  run.belief.doubt_prediction();
  run.belief.let_go(item);
  std::optional<Carried> held;
  const std::optional<planning::Plan>& plan = run.agenda.top().plan;
  if (may_hang_as_planned && plan && run.executor.is_holding()) {
    const planning::Attempt& attempt = *plan->best;
    const Matrix3 R_WP = run.belief.now().scenario.aligner->X_WA.R * attempt.planned.X_TP.R;
    held = Carried{item, run.scene().planned_box(item), R_WP, attempt.X_PS, attempt.swing};
  }
  run.executor.run({item,
                    run.belief.now().items[item.slot()].id,
                    plan_return(run.scene(), run.executor.robot(), item, held),
                    {std::nullopt, true},
                    {}});
}

void forget_displacement(Run& run) {
  ItemTask& task = run.agenda.top();
  const model::ItemIndex culprit = task.recovery.culprit;
  const auto& box = run.belief.box(culprit);
  task.before[culprit.slot()] = box ? std::optional<Pose>(box->X_WP) : std::nullopt;
}

void note_remedy(Run& run, Trouble trouble, Remedy remedy, std::string detail, bool is_of_motion) {
  ItemTask& task = run.agenda.top();
  task.last_remedy = remedy;
  run.log(event::Remedied{run.executor.time(), task.item, trouble, remedy, std::move(detail), is_of_motion});
}

void end_item(ItemTask& task, ItemEnd end, std::string reason) {
  task.end = end;
  task.reason = std::move(reason);
}

void give_up(Run& run, Trouble trouble) {
  ItemTask& task = run.agenda.top();
  const bool is_gone = !run.belief.box(task.item) || trouble == Trouble::Gone;
  const bool is_waiting = !is_gone && run.scene().locate(task.item) == planning::Location::Aligner;
  // What sticks out by little may be mended in the end, when the finished load is judged.
  const bool is_in = trouble == Trouble::SticksOut && !is_gone && run.scene().fit_of(task.item).is_in;
  end_item(task,
           is_gone      ? ItemEnd::Gone
           : is_waiting ? ItemEnd::NotHeld
           : is_in      ? ItemEnd::Accepted
                        : ItemEnd::Left,
           name_of(trouble));
}

void leave(Run& run) {
  ItemTask& task = run.agenda.top();
  const auto& sent = run.belief.now().sent;
  if (std::ranges::find(sent, task.item) == sent.end()) return;
  if (run.scene().locate(task.item) == planning::Location::Aligner) {
    task.end = task.last_remedy == Remedy::ReturnToAligner ? ItemEnd::Returned : ItemEnd::NotHeld;
  } else {
    task.end = run.scene().fit_of(task.item).is_in ? ItemEnd::Accepted : ItemEnd::Left;
  }
}

void stop(Run& run, StopReason reason, std::string text) {
  if (run.stop) return;
  run.stop = reason;
  run.log(event::Stopped{reason, text.empty() ? name_of(reason) : std::move(text)});
}

Signal act(State state, Run& run) {
  switch (state) {
    case State::NextItem:
      return take_next_item(run);
    case State::Bring:
      return bring_item(run);
    case State::PerceiveItem:
      return perceive_item(run);
    case State::CheckItem:
      return check_item(run);
    case State::Plan:
      return plan_item(run);
    case State::TakeOut:
      return take_out(run);
    case State::AskOperator:
      return ask_operator(run);
    case State::MakeRoom:
      return make_room(run);
    case State::PutBack:
      return put_back(run);
    case State::Send:
      return send_motion(run);
    case State::Moving:
      return follow_motion(run);
    case State::LookAhead:
      return look_ahead(run);
    case State::StageDone:
      return perceive_stage(run);
    case State::MotionDone:
      return end_motion(run);
    case State::Assess:
      return assess_motion(run);
    case State::Remedy:
      return choose(run);
    case State::Resume:
      return resume(run);
    case State::SetDown:
      return set_down(run);
    case State::Release:
      return release(run);
    case State::PressLevel:
      return press_level(run);
    case State::ReturnToAligner:
      return return_to_aligner(run);
    case State::Repack:
      return repack(run);
    case State::FinishItem:
      return finish_item(run);
    case State::ResumeItem:
      return resume_item(run);
    case State::GoHome:
      return go_home(run);
    case State::Done:
      break;
  }
  return Signal::Finished;
}

}  // namespace snug::session::internal
