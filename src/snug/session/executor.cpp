// Executor: sends motions to the plant and reads what comes of them; the only one who drives it.
#include "snug/session/executor.hpp"

#include <utility>

namespace snug::session {

Executor::Executor(plant::Plant& plant, const model::Scenario& scenario, EventSink log)
    : plant_(plant),
      pressure_held_(scenario.motion_guards.needed_vacuum * scenario.cup.vacuum.pressure_gauge_hold),
      log_(std::move(log)),
      robot_(plant.read()) {}

bool Executor::is_holding() const { return robot_.io.vacuum && robot_.pressure_gauge < pressure_held_; }

plant::Event Executor::wait_for(const std::function<bool(const plant::Event&)>& wanted) {
  for (;;) {
    std::optional<plant::Event> found;
    for (plant::Event& event : plant_.advance()) {
      if (!found && wanted(event)) {
        found = std::move(event);
      } else {
        kept_.push_back(std::move(event));
      }
    }
    if (found) return std::move(*found);
  }
}

bool Executor::bring(model::ItemIndex item, const std::string& id, bool is_ahead) {
  if (!plant_.bring(model::ParcelId(id))) return false;
  const plant::Event event = wait_for([&](const plant::Event& one) {
    const auto* arrived = plant::get<plant::ItemArrived>(one);
    return (arrived != nullptr && arrived->item.value == id) || plant::get<plant::FaultRaised>(one) != nullptr;
  });
  if (plant::get<plant::ItemArrived>(event) == nullptr) return false;
  log_(event::ItemBrought{event.time, item, is_ahead});
  return true;
}

perception::Observation Executor::perceive(std::span<const perception::Expectation> expected) {
  plant_.perceive(expected);
  const plant::Event event =
      wait_for([](const plant::Event& one) { return plant::get<plant::Perceived>(one) != nullptr; });
  const perception::Observation& seen = plant::get<plant::Perceived>(event)->observation;
  log_(event::Perceived{event.time, static_cast<int>(seen.seen.size()), seen.not_seen, seen.missing, seen.fault});
  return seen;
}

void Executor::start(MotionOrder order) {
  order_ = std::move(order);
  has_moved_ = true;
  kept_.clear();
  log_(event::MotionStarted{robot_.time, order_.item, order_.waypoints});
  plant_.start({model::ParcelId(order_.id), order_.waypoints, order_.guards, order_.leaves});
}

Executor::Pass Executor::advance() {
  for (;;) {
    while (!kept_.empty()) {
      const plant::Event event = std::move(kept_.front());
      kept_.pop_front();
      const auto* passed = plant::get<plant::WaypointPassed>(event);
      if (passed != nullptr && order_.leaves == passed->waypoint) return Pass::ToolLeaves;
      const auto* ended = plant::get<plant::MotionEnded>(event);
      if (ended == nullptr) continue;
      robot_ = ended->feedback;
      log_(event::MotionEnded{robot_.time, order_.item, robot_.end, split_seconds(order_.waypoints, robot_.times),
                              robot_.peak_force, robot_.peak_torque});
      return Pass::Ended;
    }
    for (plant::Event& event : plant_.advance()) kept_.push_back(std::move(event));
  }
}

void Executor::run(MotionOrder order) {
  start(std::move(order));
  while (advance() != Pass::Ended) {
  }
}

}  // namespace snug::session
