// What a session does first that goes on where another ended: the tool is somewhere, and may hold a box.
#include <algorithm>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/session/internal/run.hpp"
#include "snug/session/remedy_motions.hpp"

namespace snug::session::internal {
namespace {

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

[[noreturn]] void leave_to_hand(const std::string& what) {
  throw InputError("--resume", "the cup", what, "the box at the aligner: take it out of the cup by hand");
}

/// Down where it can be picked again. What else came is where it was. A robot that stopped on the way tries the next of
/// the ways that there are, from where it stopped.
void put_held_down(Run& run) {
  constexpr double kLifted = 0.01;  // m
  const int most_stops = run.belief.now().scenario.recovery.most_stops;
  bool is_lifted = false;
  for (int stops = 0;;) {
    const std::optional<model::ItemIndex> held = find_held(run);
    if (!held) leave_to_hand("a box that hangs from it and is not seen there");
    const planning::Scene scene = run.scene();
    const std::string& id = scene.belief.items[held->slot()].id;
    const Pose X_ES{Matrix3::Identity(), scene.rules().cup.hold_length * Vector3::UnitZ()};
    const Pose X_PS = scene.X_WP(*held).inverse() * run.executor.robot().X_WE * X_ES;
    const auto ways = plan_put_aside(scene, run.executor.robot(), *held, X_PS);
    if (ways.empty()) leave_to_hand(id + ", for which there is no free place that the arm reaches");
    std::vector<motion::Waypoint> way = ways[std::min(static_cast<std::size_t>(stops), ways.size() - 1)];
    // It may lean on something or be pressed on it: how it hangs shows when it is up.
    is_lifted = is_lifted || way.front().X_WE.p.z() - run.executor.robot().X_WE.p.z() < kLifted;
    if (!is_lifted) way.resize(1);
    run.executor.run({*held, id, std::move(way), {std::nullopt, true}, {}});
    if (run.executor.has_completed()) {
      if (std::exchange(is_lifted, true)) break;
      continue;
    }
    if (!run.executor.is_holding()) {
      retreat(run, *held);
      break;
    }
    const plant::EndReason end = run.executor.robot().end.reason;
    const bool may_try = end == plant::EndReason::ProtectiveStop || end == plant::EndReason::Timeout;
    if (!may_try || ++stops > most_stops)
      leave_to_hand(id + ", which cannot be put down: " + run.executor.describe_end());
    run.executor.acknowledge();
    is_lifted = false;
  }
  for (const model::ItemIndex item : run.options.resume->to_do) run.belief.forget(item);  // they are brought
}

}  // namespace

void take_over(Run& run) {
  run.executor.refresh();
  for (const model::ItemIndex item : run.options.resume->to_do)  // whoever resumes this session, too, has to know
    run.log(event::ItemBrought{run.executor.time(), item, false});
  constexpr double kAtStart = 0.02;  // m
  const Pose& X_WE_start = run.belief.now().scenario.controller.X_WE_start;
  const bool is_at_start = (run.executor.robot().X_WE.p - X_WE_start.p).norm() < kAtStart;
  if (run.executor.is_holding()) return put_held_down(run);
  if (!is_at_start && !run.agenda.order.empty()) retreat(run, run.agenda.order.front());
}

}  // namespace snug::session::internal
