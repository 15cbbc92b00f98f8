// What several states of a session have in common: perceiving, letting go, and words for what became of an item.
#include <algorithm>
#include <utility>

#include "snug/core/input_error.hpp"
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

/// The box at the lip, of those that are seen now.
std::optional<model::ItemIndex> find_held(Run& run) {
  for (const model::ItemIndex item : run.options.resume->to_do) run.belief.arrives(item);
  const perception::Observation seen = run.executor.perceive(run.belief.expectations());
  run.belief.see(seen);
  constexpr double kBesideLip = 0.05;  // m: a cup that presses is that much shorter
  const planning::Scene scene = run.scene();
  const Vector3 p_WS = run.executor.robot().X_WE * (scene.rules().cup.hold_length * Vector3::UnitZ());
  std::optional<model::ItemIndex> held;
  double nearest = kBesideLip;
  for (std::size_t i = 0; i < scene.belief.boxes.size(); ++i) {
    const auto& box = scene.belief.boxes[i];
    if (!box || !box->was_seen) continue;
    const Vector3 beyond = (box->X_WP.inverse() * p_WS).cwiseAbs() - 0.5 * scene.belief.items[i].size;
    const double distance = beyond.cwiseMax(0.0).norm() + std::abs(std::min(0.0, beyond.maxCoeff()));
    if (distance >= nearest) continue;
    nearest = distance;
    held = model::ItemIndex(i);
  }
  return held;
}

/// To the aligner, as it hangs. What else came is where it was.
void return_held(Run& run) {
  const std::optional<model::ItemIndex> held = find_held(run);
  if (!held)
    throw InputError("--resume", "the cup", "a box that hangs from it and is not seen there",
                     "the box at the aligner: take it out of the cup by hand");
  const planning::Scene scene = run.scene();
  const Pose X_ES{Matrix3::Identity(), scene.rules().cup.hold_length * Vector3::UnitZ()};
  const Pose X_WS = run.executor.robot().X_WE * X_ES;
  const Carried carried{scene.planned_box(*held), rotation_at_aligner(scene, *held), scene.X_WP(*held).inverse() * X_WS,
                        std::nullopt};
  const std::string& id = scene.belief.items[held->slot()].id;
  run.executor.run({*held, id, plan_return(scene, run.executor.robot(), *held, carried), {std::nullopt, true}, {}});
  if (!run.executor.has_completed())
    throw InputError("--resume", "the cup", id + ", which cannot be put to the aligner: " + run.executor.describe_end(),
                     "the box at the aligner: take it out of the cup by hand");
  for (const model::ItemIndex item : run.options.resume->to_do) run.belief.forget(item);  // they are brought
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
    held = Carried{run.scene().planned_box(item), R_WP, attempt.X_PS, attempt.swing};
  }
  run.executor.run({item,
                    run.belief.now().items[item.slot()].id,
                    plan_return(run.scene(), run.executor.robot(), item, held),
                    {std::nullopt, true},
                    {}});
}

void take_over(Run& run) {
  run.executor.refresh();
  for (const model::ItemIndex item : run.options.resume->to_do)  // whoever resumes this session, too, has to know
    run.log(event::ItemBrought{run.executor.time(), item, false});
  constexpr double kAtStart = 0.02;  // m
  const Pose& X_WE_start = run.belief.now().scenario.controller.X_WE_start;
  const bool is_at_start = (run.executor.robot().X_WE.p - X_WE_start.p).norm() < kAtStart;
  if (run.executor.is_holding()) return return_held(run);
  if (!is_at_start && !run.agenda.order.empty()) retreat(run, run.agenda.order.front());
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
  end_item(task, is_gone ? ItemEnd::Gone : is_waiting ? ItemEnd::NotHeld : ItemEnd::Left, name_of(trouble));
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
