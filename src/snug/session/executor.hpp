// Executor: sends motions to the plant and reads what comes of them; the only one who drives it.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/plant/event.hpp"
#include "snug/session/event_log.hpp"

namespace snug::session {

/// What to send.
struct MotionOrder {
  model::ItemIndex item;  ///< that it is for; none: the way home
  std::string id;         ///< of that item; empty: none
  std::vector<motion::Waypoint> waypoints;
  plant::Guards guards;
  std::optional<motion::WaypointIndex> leaves;  ///< Pass::ToolLeaves is said when the tool has passed it
};

class Executor {
 public:
  enum class Pass { ToolLeaves, Ended };

  Executor(plant::Plant& plant, const model::Scenario& scenario, EventSink log);

  /// As the last motion left it, or as refresh() found it.
  [[nodiscard]] const plant::Feedback& robot() const { return robot_; }
  [[nodiscard]] double time() const { return robot_.time; }
  [[nodiscard]] bool has_completed() const { return robot_.end.reason == plant::EndReason::Completed; }
  /// Of the last motion.
  [[nodiscard]] const std::vector<motion::Waypoint>& waypoints() const { return order_.waypoints; }
  /// The vacuum says that something hangs from the cup.
  [[nodiscard]] bool is_holding() const;
  /// How the last motion ended, for people.
  [[nodiscard]] std::string describe_end() const { return plant::describe(robot_.end, order_.waypoints); }
  [[nodiscard]] bool has_moved() const { return has_moved_; }

  void refresh() { robot_ = plant_.read(); }
  /// Sensors now, also while a motion is under way.
  [[nodiscard]] plant::Feedback read() { return plant_.read(); }
  /// Until it has arrived, or does not come: false. A motion that is under way goes on.
  [[nodiscard]] bool bring(model::ItemIndex item, const std::string& id, bool is_ahead);
  [[nodiscard]] perception::Observation perceive(std::span<const perception::Expectation> expected);
  void acknowledge() { plant_.acknowledge(); }
  void start(MotionOrder order);
  /// Until the tool leaves the waypoint that was asked for, or the motion has ended.
  [[nodiscard]] Pass advance();
  /// From its start to its end.
  void run(MotionOrder order);

 private:
  /// Until one event is `wanted`; the others are kept for advance(), in their order.
  plant::Event wait_for(const std::function<bool(const plant::Event&)>& wanted);

  plant::Plant& plant_;
  double pressure_held_;  ///< Pa, below it something hangs from the cup
  EventSink log_;
  MotionOrder order_;
  std::deque<plant::Event> kept_;
  plant::Feedback robot_;
  bool has_moved_ = false;
};

}  // namespace snug::session
