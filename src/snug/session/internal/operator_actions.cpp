// What states of a session do: what who operates wants, in the place of what the session decided.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "snug/packing/container_state.hpp"
#include "snug/session/internal/run.hpp"
#include "snug/session/remedy_motions.hpp"

namespace snug::session::internal {
namespace {

constexpr std::chrono::milliseconds kBetweenQuestions(50);  // wall clock, to an operator who holds the session
constexpr double kSamePlace = 0.005;                        ///< m, within which two candidates are one place
constexpr double kOnTop = 0.02;                             ///< m, that a box on another may be sunk in

void note_order(Run& run, const OperatorOrder& order, bool was_followed, std::string text) {
  run.log(event::Operated{run.executor.time(), run.agenda.top().item, order.line, format_operator_order(order),
                          was_followed, std::move(text)});
}

bool is_same_place(const packing::Placement& a, const packing::Placement& b) {
  return a.orientation == b.orientation && (a.X_TP.p - b.X_TP.p).norm() < kSamePlace;
}

/// A candidate by its number, or why there is none.
Expected<packing::Placement, std::string> find_candidate(const ItemTask& task, int number) {
  if (number > static_cast<int>(task.tried.size()))
    return tl::unexpected(fmt::format("there are {} candidates", task.tried.size()));
  const packing::Placement& wanted = task.tried[static_cast<std::size_t>(number) - 1].planned;
  if (is_same_place(wanted, task.plan->best->planned)) return tl::unexpected(std::string("it is planned there"));
  return wanted;
}

/// The best candidate that is neither planned now nor was refused nor failed.
Expected<packing::Placement, std::string> find_elsewhere(const ItemTask& task) {
  const planning::Tried* best = nullptr;
  for (const planning::Tried& one : task.tried) {
    const bool has_failed = one.verdict == planning::Verdict::Failed || one.verdict == planning::Verdict::SentBefore ||
                            one.verdict == planning::Verdict::GraspKnown;
    const auto is_it = [&](const packing::Placement& other) { return is_same_place(one.planned, other); };
    if (has_failed || std::ranges::any_of(task.refused_places, is_it)) continue;
    if (best == nullptr || one.utility > best->utility) best = &one;
  }
  if (best == nullptr) return tl::unexpected(std::string("no other candidate is left"));
  return best->planned;
}

/// True: it is planned there now.
bool ask_for_place(Run& run, const OperatorOrder& order) {
  ItemTask& task = run.agenda.top();
  const bool is_any = order.action == OperatorAction::Elsewhere;
  if (is_any) task.refused_places.push_back(task.plan->best->planned);
  const auto place = is_any ? find_elsewhere(task) : find_candidate(task, order.candidate);
  if (!place) {
    note_order(run, order, false, place.error());
    return false;
  }
  task.refused_places.push_back(*place);  // not again, if no motion is found
  task.asked_place = *place;
  task.asked_by = order;
  const Vector3 p = 1e3 * place->X_TP.p;
  note_order(run, order, true, fmt::format("({:.0f}, {:.0f}, {:.0f}) mm is planned", p.x(), p.y(), p.z()));
  return true;
}

/// A box that stands on it; empty: none.
std::string box_upon(const Run& run, model::ItemIndex item) {
  const packing::ContainerState load = run.scene().container_state();
  const auto own = std::ranges::find(load.boxes, run.belief.now().items[item.slot()].id,
                                     [](const packing::PlacedBox& one) { return one.item.id; });
  if (own == load.boxes.end()) return {};
  const packing::Extent below = packing::bounding_extent(*own);
  for (const packing::PlacedBox& one : load.boxes) {
    if (one.item.id == own->item.id) continue;
    const packing::Extent above = packing::bounding_extent(one);
    const bool is_over = above.low.x() < below.high.x() && above.high.x() > below.low.x() &&
                         above.low.y() < below.high.y() && above.high.y() > below.low.y();
    if (is_over && above.low.z() > below.high.z() - kOnTop) return one.item.id;
  }
  return {};
}

/// Why it cannot be taken out; empty: it can.
std::string why_it_stays(const Run& run, std::optional<model::ItemIndex> item) {
  if (!item || std::ranges::find(run.agenda.packed, *item) == run.agenda.packed.end()) return "it is not packed";
  if (const std::string upon = box_upon(run, *item); !upon.empty()) return upon + " stands on it";
  if (!run.scene().can_be_picked(*item) || !can_return(run.scene(), *item)) return "it cannot be picked where it lies";
  return {};
}

}  // namespace

void refuse_place(Run& run, const std::string& why) {
  note_order(run, run.agenda.top().asked_by, false, "no motion was found: " + why);
}

Signal ask_operator(Run& run) {
  ItemTask& task = run.agenda.top();
  for (;;) {
    const std::optional<OperatorOrder> order = run.desk.take_order(task.id);
    if (!order) {
      if (!task.is_held || run.desk.is_over()) return Signal::GoOn;
      if (run.options.is_interrupted && run.options.is_interrupted()) {
        stop(run, StopReason::Interrupted, "interrupted");
        leave(run);
        task.reason = name_of(*run.stop);
        return Signal::Stopped;
      }
      std::this_thread::sleep_for(kBetweenQuestions);
      continue;
    }
    switch (order->action) {
      case OperatorAction::Hold:
        task.is_held = true;
        note_order(run, *order, true, "the operator is waited for");
        break;
      case OperatorAction::Go:
        note_order(run, *order, task.is_held, task.is_held ? "" : "nothing is held");
        task.is_held = false;
        break;
      case OperatorAction::Skip:
        note_order(run, *order, true, "");
        end_item(task, ItemEnd::Skipped, "by the operator");
        return Signal::Skip;
      case OperatorAction::Place:
      case OperatorAction::Elsewhere:
        if (ask_for_place(run, *order)) return Signal::AnotherPlace;
        break;
      case OperatorAction::TakeOut:
        note_order(run, *order, false, task.id + " stands at the aligner already: before the next one it could be");
        break;
    }
  }
}

Signal take_out(Run& run) {
  const ItemTask& task = run.agenda.top();
  const std::optional<OperatorOrder> order = run.desk.take_out_order(task.id);
  if (!order) return Signal::Finished;
  const std::optional<model::ItemIndex> item = run.belief.find(order->box);
  if (const std::string why = why_it_stays(run, item); !why.empty()) {
    note_order(run, *order, false, why);
    return Signal::Finished;
  }
  note_order(run, *order, true, "");
  run.belief.doubt_prediction();
  run.belief.let_go(*item);
  run.executor.run({*item,
                    order->box,
                    plan_return(run.scene(), run.executor.robot(), *item, std::nullopt),
                    {run.cell.limits.force, true},
                    {}});
  const std::string end = run.executor.has_completed() ? std::string() : run.executor.describe_end();
  if (!end.empty()) retreat(run, *item);
  perceive(run);
  const bool is_there = run.belief.box(*item).has_value();
  const planning::Location where = is_there ? run.scene().locate(*item) : planning::Location::Aligner;
  if (where == planning::Location::Container) {
    note_order(run, *order, false, end.empty() ? "it is still in the container" : end);
    return Signal::Finished;
  }
  if (where == planning::Location::Aligner) {
    run.belief.forget(*item);  // the next arrival takes it away
  } else {
    note_order(run, *order, false, "it did not come to the aligner" + (end.empty() ? end : ": " + end));
    run.agenda.left_out.insert(*item);
  }
  run.belief.edit().skipped.push_back(*item);
  std::erase(run.agenda.packed, *item);
  run.log(event::ItemLost{*item, ItemEnd::TakenOut, "by the operator"});
  return Signal::Finished;
}

}  // namespace snug::session::internal
