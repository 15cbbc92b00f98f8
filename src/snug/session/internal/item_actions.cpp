// What states of a session do: from the order to the motion, and what became of the item.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "snug/packing/load_check.hpp"
#include "snug/session/internal/run.hpp"
#include "snug/session/remedy_motions.hpp"

namespace snug::session::internal {
namespace {

constexpr double kStill = 0.005;  ///< m, less than which a box that is at rest is seen to move

event::Planned event_of(const Decided& decided, double time) {
  const planning::Plan& plan = decided.plan;
  event::Planned one;
  one.time = time;
  one.item = plan.item;
  one.outcome = plan.outcome;
  one.reason = plan.reason;
  one.tried = plan.tried;
  one.attempts = plan.attempts;
  one.stops = plan.stops;
  one.flips = plan.flips;
  one.predicted_success = plan.predicted_success;
  one.decision_seconds = plan.decision_seconds;
  one.rehearsal_seconds = plan.rehearsal_seconds;
  one.waited = decided.waited;
  one.belief_file = decided.belief_file;
  one.hash = decided.hash;
  if (!plan.best) return one;
  one.planned = plan.best->planned;
  one.reorientation = plan.best->reorientation;
  one.skill = plan.best->skill;
  one.samples = plan.best->samples;
  one.success_rate = plan.best->success_rate;
  one.predicted = plan.best->predicted;
  return one;
}

void begin_item(Run& run, model::ItemIndex item, std::optional<model::ItemIndex> because_of) {
  ItemTask& task = run.agenda.under_way.emplace_back();
  task.item = item;
  task.id = run.belief.now().items[item.slot()].id;
  task.begun = run.executor.time();
  run.log(event::ItemStarted{task.begun, item, because_of});
}

constexpr int kMostRooms = 3;  ///< boxes that move for an item without which the session ends

/// For an item that is at the aligner for the first time: once, or more often where the session ends without it.
bool may_make_room(const Run& run) {
  const ItemTask& task = run.agenda.top();
  const int most = run.belief.now().skips_left <= 0 ? kMostRooms : 1;
  return run.agenda.under_way.size() == 1 && task.sends == 0 && !task.aside && task.rooms < most;
}

/// The plan that was made ahead, or one that is made now.
Decided decide(Run& run) {
  ItemTask& task = run.agenda.top();
  if (task.ready) return std::move(*std::exchange(task.ready, std::nullopt));
  planning::BeliefSnapshot& belief = run.belief.edit();
  const plant::Feedback& robot = run.executor.robot();
  belief.robot = {robot.X_WE, robot.q, robot.io};
  belief.next = run.agenda.follower_of(task.item);
  if (task.asked_place) return run.decisions.decide_at(belief, task.item, *task.asked_place);
  if (task.aside && task.sends == 0) {  // so that both have a place
    Decided there = run.decisions.decide_at(belief, task.item, task.aside->item);
    if (there.plan.best) return there;
  }
  return run.decisions.decide(belief, task.item, may_make_room(run));
}

/// What was packed before, and is seen outside or nowhere now, is not packed any more.
void review(Run& run) {
  std::erase_if(run.agenda.packed, [&](model::ItemIndex item) {
    const bool is_gone = !run.belief.box(item);
    if (!is_gone && !run.scene().is_seen_outside(item)) return false;
    const bool was_returned = run.agenda.returned.contains(item);
    const char* reason = was_returned ? "it was moved, and no other place was found for it"
                         : is_gone    ? "it is not seen any more"
                                      : "it is seen outside the container";
    run.log(event::ItemLost{item, was_returned ? ItemEnd::Returned : is_gone ? ItemEnd::Gone : ItemEnd::Left, reason});
    return true;
  });
}

/// The boxes of items that are done with.
std::vector<event::Standing> standing(const Run& run) {
  std::vector<event::Standing> boxes;
  const planning::BeliefSnapshot& belief = run.belief.now();
  for (std::size_t i = 0; i < belief.boxes.size(); ++i) {
    const model::ItemIndex item(i);
    const bool is_to_come = std::ranges::find(run.agenda.order.begin() + static_cast<std::ptrdiff_t>(run.agenda.next),
                                              run.agenda.order.end(), item) != run.agenda.order.end();
    if (belief.boxes[i] && !is_to_come) boxes.push_back({item, belief.boxes[i]->X_WP, belief.items[i].size});
  }
  return boxes;
}

void count(Run& run) {
  const model::Scenario& scenario = run.belief.now().scenario;
  std::vector<std::string> packed;
  for (const model::ItemIndex item : run.agenda.packed) packed.push_back(run.belief.now().items[item.slot()].id);
  const model::Container& container = *model::find_container(scenario, scenario.target);
  run.log(event::Counted{run.executor.time(), model::compute_filling_degree_percent(scenario, container, packed),
                         run.belief.obstacles().reports(), standing(run)});
}

/// Box by box, three standard deviations of what is seen.
std::vector<packing::PoseDoubt> doubts_of(const Run& run, const packing::ContainerState& load) {
  std::vector<packing::PoseDoubt> doubts;
  for (const packing::PlacedBox& one : load.boxes) {
    packing::PoseDoubt& doubt = doubts.emplace_back();
    const std::optional<model::ItemIndex> item = run.belief.find(one.item.id);
    if (!item || !run.belief.box(*item)) continue;
    const Vector6 variance = run.belief.box(*item)->covariance.diagonal().cwiseMax(0.0);
    doubt.position = 3.0 * std::sqrt(variance.head<3>().maxCoeff());
    doubt.angle = 3.0 * std::sqrt(variance.tail<3>().maxCoeff());
  }
  return doubts;
}

/// How far boxes of the load give on a surface: the softest of them; rigid where the scenario says nothing of it.
/// `below` of none: on each other.
packing::Give give_of(const model::Scenario& scenario, const packing::ContainerState& load,
                      std::optional<model::MaterialId> below) {
  packing::Give softest;
  for (const packing::PlacedBox& box : load.boxes) {
    const model::Parcel* parcel = model::find_parcel(scenario, box.item.id);
    if (parcel == nullptr) continue;
    const auto contact = model::find_contact(scenario, parcel->material, below.value_or(parcel->material));
    if (!contact || !contact->stiffness) continue;
    const packing::Give give{1.0 / *contact->stiffness, contact->full_area.value_or(0.0)};
    if (give.per_force > softest.per_force) softest = give;
  }
  return softest;
}

using Findings = std::map<model::ItemIndex, std::string>;

/// What does not lie as in a finished load, of the boxes that are packed, as the load is seen when the robot stands at
/// its start. `before`: where boxes were believed to be before the robot went there, which takes a second and touches
/// nothing. None: nothing is seen.
std::optional<Findings> judge_load(Run& run, const std::vector<std::optional<Pose>>& before) {
  const perception::Observation seen = run.executor.perceive(run.belief.expectations());
  if (seen.fault != perception::LookFault::None) return std::nullopt;
  run.belief.see(seen);
  run.belief.forget_let_go();
  review(run);
  const planning::Scene scene = run.scene();
  packing::ContainerState load = scene.container_state();
  load.obstacles.clear();
  packing::LoadLimits limits;
  limits.tilt = scene.cell.limits.tilt;
  limits.min_support = std::min(limits.min_support, scene.rules().packing.min_support);
  const model::Scenario& nominal = scene.belief.nominal();
  limits.on_floor = give_of(nominal, load, model::find_container(nominal, nominal.target)->material);
  limits.on_box = give_of(nominal, load, std::nullopt);
  std::map<std::string, std::string> reasons;
  for (const packing::LoadFinding& one : packing::check_finished_load(load, limits, doubts_of(run, load))) {
    reasons.emplace(one.item, packing::describe(one));
  }
  Findings findings;
  for (const model::ItemIndex item : run.agenda.packed) {
    const auto& box = scene.box(item);
    if (!box || !box->was_seen) continue;
    const auto found = reasons.find(scene.belief.items[item.slot()].id);
    if (found != reasons.end()) findings.emplace(item, found->second);
    if (!before[item.slot()]) continue;
    const double moved = (box->X_WP.p - before[item.slot()]->p).norm() - planning::slack_of(*box);
    if (moved > kStill) findings.emplace(item, fmt::format("still moves ({:.0f} mm)", 1e3 * moved));
  }
  return findings;
}

/// The robot goes to its start, and the load is judged. None: it is not there, or sees nothing.
std::optional<Findings> go_home_and_judge(Run& run) {
  const std::vector<std::optional<Pose>> before = run.scene().believed_poses();
  move_home(run);
  if (!run.executor.has_completed() || run.agenda.packed.empty()) return std::nullopt;
  return judge_load(run, before);
}

/// What is seen now is believed, if anything is.
void look(Run& run) {
  const perception::Observation seen = run.executor.perceive(run.belief.expectations());
  if (seen.fault == perception::LookFault::None) run.belief.see(seen);
  run.belief.forget_let_go();
}

/// Each that nothing stands on and that was not pressed before; true: something was pressed.
bool press_all(Run& run, const Findings& findings) {
  bool has_pressed = false;
  for (const auto& [item, reason] : findings) {
    const planning::Scene scene = run.scene();
    if (!scene.box(item) || run.agenda.pressed.contains(item)) continue;
    if (scene.is_under_box(item) || scene.is_under_obstacle(item)) continue;
    if (scene.locate(item) != planning::Location::Container) continue;
    press_on(run, item);
    has_pressed = true;
    if (!run.executor.has_completed()) break;
  }
  if (has_pressed) look(run);
  return has_pressed;
}

/// The first that can be: to the bench, where it is no part of the load. True: the robot moved for it.
bool take_one_out(Run& run, const Findings& findings) {
  for (const auto& [item, reason] : findings) {
    const planning::Scene scene = run.scene();
    if (!scene.box(item) || scene.locate(item) != planning::Location::Container) continue;
    std::vector<motion::Waypoint> waypoints = plan_take_out(scene, run.executor.robot(), item);
    if (waypoints.empty()) continue;
    const std::string& id = scene.belief.items[item.slot()].id;
    run.belief.doubt_prediction();
    run.belief.let_go(item);
    run.executor.run({item, id, std::move(waypoints), {run.cell.limits.force, true}, {}});
    if (!run.executor.has_completed()) retreat(run, item);
    look(run);
    const bool is_out = run.belief.box(item) && run.scene().locate(item) == planning::Location::Bench;
    if (is_out) {
      std::erase(run.agenda.packed, item);
      run.log(event::ItemLost{item, ItemEnd::TakenOut, reason + ": it is put on the bench"});
    }
    return true;
  }
  return false;
}

/// The robot to its start. What of the load is not as in a finished one is pressed, then taken out; what cannot be
/// mended so is not packed.
void finish_load(Run& run) {
  std::optional<Findings> findings = go_home_and_judge(run);
  const bool may_move =
      run.stop != StopReason::Interrupted && run.stop != StopReason::PlantFault && run.stop != StopReason::RobotStops;
  for (const auto& mend : {press_all, take_one_out}) {
    if (!may_move || !findings || findings->empty() || !mend(run, *findings)) continue;
    if (auto again = go_home_and_judge(run)) findings = std::move(again);  // else it is as it was
  }
  if (!findings) return;
  for (const auto& [item, reason] : *findings) {
    if (std::erase(run.agenda.packed, item) > 0) run.log(event::ItemLost{item, ItemEnd::Rejected, reason});
  }
}

bool is_taken_away(ItemEnd end) {
  return end == ItemEnd::NoPlace || end == ItemEnd::Infeasible || end == ItemEnd::NotHeld || end == ItemEnd::Returned ||
         end == ItemEnd::WrongItem || end == ItemEnd::Gone || end == ItemEnd::Skipped;
}

/// Why the order is at its end.
void say_why_it_ends(Run& run) {
  if (run.stop) return;
  const Agenda& agenda = run.agenda;
  const std::size_t left = static_cast<std::size_t>(agenda.reported) - agenda.packed.size();
  if (!agenda.order_ends.empty()) {
    stop(run, StopReason::NoPlace, agenda.order_ends);
  } else if (run.belief.now().items.empty()) {
    stop(run, StopReason::NoItems, "no items");
  } else if (left == 0) {
    stop(run, StopReason::AllPacked, "all items are packed");
  } else {
    stop(run, StopReason::NoMoreItems, fmt::format("no more items, {} not packed", left));
  }
}

}  // namespace

void account_for(Run& run, model::ItemIndex item, ItemEnd end) {
  planning::BeliefSnapshot& belief = run.belief.edit();
  const bool is_packed = end == ItemEnd::Placed || end == ItemEnd::Accepted;
  if (!is_packed && end != ItemEnd::NotBrought) belief.skipped.push_back(item);
  if (end == ItemEnd::NoPlace) --belief.skips_left;
  ++run.agenda.reported;
  if (is_packed) run.agenda.packed.push_back(item);
}

Signal take_next_item(Run& run) {
  Agenda& agenda = run.agenda;
  if (agenda.next == agenda.order.size()) return Signal::OrderDone;
  if (!run.stop && run.options.is_interrupted && run.options.is_interrupted()) {
    stop(run, StopReason::Interrupted, "interrupted");
  }
  if (run.stop) return Signal::Stopped;
  const model::ItemIndex item = agenda.order[agenda.next++];
  auto ahead = run.decisions.take_ahead(item);
  run.executor.refresh();
  begin_item(run, item, std::nullopt);
  if (!ahead && run.desk.wants_out(agenda.top().id)) return Signal::TakeOut;
  if (!ahead) return Signal::ItemToBring;
  agenda.top().ready = std::move(ahead->decided);
  return ahead->is_seen ? Signal::ItemIsHere : Signal::ItemIsUnseen;
}

Signal bring_item(Run& run) {
  ItemTask& task = run.agenda.top();
  if (run.executor.bring(task.item, task.id, false)) {
    run.belief.arrives(task.item);
    return Signal::Brought;
  }
  end_item(task, ItemEnd::NotBrought, "the plant does not bring it");
  const plant::End end = run.executor.read().end;
  if (end.reason == plant::EndReason::Fault) {
    task.reason = plant::describe(end, {});
    stop(run, StopReason::PlantFault);
  }
  return Signal::NotBrought;
}

Signal perceive_item(Run& run) {
  perceive(run);
  if (!run.stop) return Signal::Perceived;
  end_item(run.agenda.top(), ItemEnd::NotHeld, name_of(*run.stop));
  return Signal::Stopped;
}

Signal check_item(Run& run) {
  ItemTask& task = run.agenda.top();
  const settings::RecoverySettings& settings = run.belief.now().scenario.recovery;
  if (!run.belief.box(task.item) || run.scene().size_error(task.item) <= settings.wrong_size) return Signal::RightItem;
  std::string detail = fmt::format("edges differ by up to {:.0f} mm", 1e3 * run.scene().size_error(task.item));
  note_remedy(run, Trouble::WrongItem, choose_remedy({.trouble = Trouble::WrongItem}, settings), detail, false);
  end_item(task, ItemEnd::WrongItem, std::move(detail));
  return Signal::WrongItem;
}

Signal plan_item(Run& run) {
  ItemTask& task = run.agenda.top();
  if (run.stop) {
    leave(run);
    task.reason = name_of(*run.stop);
    return Signal::Stopped;
  }
  if (!run.belief.box(task.item)) {
    give_up(run, Trouble::Gone);
    return Signal::Gone;
  }
  Decided decided = decide(run);
  run.log(event_of(decided, run.executor.time()));
  run.belief.edit().items[task.item.slot()] = decided.plan.standing;
  task.attempts += decided.plan.attempts;
  const bool is_found = decided.plan.outcome == planning::PlanOutcome::Found;
  const bool has_operator = run.desk.is_manned() && run.agenda.under_way.size() == 1;
  const bool is_asked = std::exchange(task.asked_place, std::nullopt).has_value();
  if (is_asked && !is_found) {  // what was planned before stays
    refuse_place(run, decided.plan.reason);
    return Signal::ToBeConfirmed;
  }
  task.reason = decided.plan.reason;
  if (!is_asked) task.tried = decided.plan.tried;
  if (is_found) {
    task.plan = std::move(decided.plan);
    task.stage = 0;
    return has_operator ? Signal::ToBeConfirmed : Signal::Planned;
  }
  const bool is_infeasible = decided.plan.outcome == planning::PlanOutcome::Infeasible;
  task.end = is_infeasible ? ItemEnd::Infeasible : ItemEnd::NoPlace;
  task.room = std::move(decided.room);
  return Signal::NoPlace;
}

namespace {

/// The box to the bench, from where it is picked when the item stands.
Signal put_aside(Run& run, const planning::Aside& aside) {
  const planning::Scene scene = run.scene();
  std::vector<motion::Waypoint> waypoints = plan_take_out(scene, run.executor.robot(), aside.box);
  if (waypoints.empty()) return Signal::NoPlace;
  const std::string& id = scene.belief.items[aside.box.slot()].id;
  run.belief.doubt_prediction();
  run.belief.let_go(aside.box);
  run.executor.run({aside.box, id, std::move(waypoints), {run.cell.limits.force, true}, {}});
  if (!run.executor.has_completed()) retreat(run, aside.box);
  perceive(run);
  run.agenda.top().aside = aside;
  return Signal::ToBePlannedAnew;
}

}  // namespace

Signal make_room(Run& run) {
  std::optional<planning::Room> room = std::exchange(run.agenda.top().room, std::nullopt);
  if (!room) return Signal::NoPlace;
  run.agenda.top().rooms += 1;
  if (room->aside) return put_aside(run, *room->aside);
  begin_item(run, room->plan.item, run.agenda.top().item);
  run.agenda.top().ready = run.decisions.decided_move(std::move(*room));
  return Signal::Started;
}

Signal put_back(Run& run) {
  ItemTask& task = run.agenda.top();
  leave(run);
  if (task.end != ItemEnd::Left) return Signal::Finished;
  if (!run.executor.is_holding() && !can_return(run.scene(), task.item)) return Signal::Finished;
  send_to_aligner(run, task.item, false);
  if (run.executor.has_completed()) task.end = ItemEnd::Returned;
  return Signal::Finished;
}

Signal finish_item(Run& run) {
  Agenda& agenda = run.agenda;
  if (std::optional<planning::Aside> aside = std::exchange(agenda.top().aside, std::nullopt)) {
    agenda.top().recovery.culprit = aside->box;
    agenda.top().brings_back = aside->box;
    return Signal::RepackOther;
  }
  ItemTask task = std::move(agenda.top());
  agenda.under_way.pop_back();
  if (!agenda.under_way.empty()) {
    run.log(event::ItemEnded{run.executor.time(), task.item, task.end, task.reason});
    agenda.finished = std::move(task);
    return Signal::NextOnAgenda;
  }
  if (is_taken_away(task.end)) run.belief.forget(task.item);  // the next arrival takes it away
  account_for(run, task.item, task.end);
  if (run.belief.now().chosen.empty() && run.belief.now().skips_left < 0) {
    stop(run, StopReason::NoPlace, fmt::format("{}: {}", task.id, task.reason));
  }
  run.log(event::ItemEnded{run.executor.time(), task.item, task.end, task.reason});
  review(run);
  count(run);
  return Signal::Finished;
}

Signal repack(Run& run) {
  begin_item(run, run.agenda.top().recovery.culprit, run.agenda.top().item);
  return Signal::Started;
}

Signal resume_item(Run& run) {
  Agenda& agenda = run.agenda;
  const ItemTask own = std::move(*std::exchange(agenda.finished, std::nullopt));
  ItemTask& task = agenda.top();
  RecoveryTask& recovery = task.recovery;
  task.attempts += own.attempts;
  if (own.last_remedy) task.last_remedy = own.last_remedy;
  if (!run.executor.has_completed()) retreat(run, own.item);
  const auto& box = run.belief.box(own.item);
  if (box && run.scene().locate(own.item) == planning::Location::Aligner) {
    run.belief.forget(own.item);  // the next arrival takes it away
    agenda.returned.insert(own.item);
  } else if (run.scene().is_seen_outside(own.item)) {
    agenda.left_out.insert(own.item);
  } else if (box && own.sends > 0) {
    const bool made_room = !task.plan || task.brings_back == own.item;
    run.log(event::Repacked{own.item, own.plan->best->planned, run.cell.layout.X_WT.inverse() * box->X_WP,
                            made_room ? std::optional(task.item) : std::nullopt});
  }
  if (!task.plan) return Signal::ToBePlannedAnew;  // it was to make room
  const bool has_moved = run.executor.time() > own.begun;
  if (recovery.ends_unless_moved && !has_moved) {
    recovery.repacked = run.belief.now().scenario.recovery.most_tries;
  } else {
    ++recovery.repacked;
  }
  recovery.was_pressed = false;
  forget_displacement(run);
  if (task.brings_back == own.item && task.end != ItemEnd::Placed) return Signal::InPlace;  // nothing more is done
  return Signal::Finished;
}

Signal go_home(Run& run) {
  event::SessionEnded ended;
  const auto is_cancelled = [&run] {  // a plant that stops where it is when the session is interrupted
    return run.stop == StopReason::Interrupted && run.executor.robot().end.reason == plant::EndReason::Cancelled;
  };
  if (run.executor.has_moved() && !is_cancelled()) {
    finish_load(run);
    if (!run.executor.has_completed() && !is_cancelled()) {
      ended.failure = SessionFailureKind::NotHome;
      ended.text = "on the way home: " + run.executor.describe_end();
    }
  }
  say_why_it_ends(run);
  count(run);
  ended.time = run.executor.time();
  run.log(ended);
  return Signal::Finished;
}

}  // namespace snug::session::internal
