// KinematicPlant: the smallest thing that is a Plant: a tool that jumps, one box on a rigid table. For the contract
// itself.
#pragma once

#include <algorithm>
#include <string>

#include "snug/plant/motion_runner.hpp"

namespace snug::plant::test {

class KinematicPlant final : public Plant {
 public:
  [[nodiscard]] Description describe() const override { return {"kinematic", {}}; }
  [[nodiscard]] Feedback read() override { return now_; }
  [[nodiscard]] bool is_moving() const override { return runner_.is_moving(); }

  void start(const Motion& motion) override {
    const std::string refusal = MotionRunner::find_refusal(motion);
    if (!refusal.empty()) return runner_.refuse(refusal, now_);
    runner_.begin(motion, reading(), is_held_);
    next_ = 0;
  }
  [[nodiscard]] std::vector<Event> advance() override {
    if (is_moving() && !runner_.has_events()) tick();
    return runner_.take_events();
  }
  void cancel() override {
    if (!is_moving()) return;
    runner_.stop(EndReason::Cancelled);
    runner_.finish(now_);
  }
  [[nodiscard]] bool bring(const model::ParcelId& item) override {
    if (item.value != "BOX" || has_come_) return false;
    has_come_ = true;
    runner_.add({now_.time, ItemArrived{item}});
    return true;
  }
  void perceive(std::span<const perception::Expectation> expected) override {
    perception::Observation seen;
    seen.time = now_.time;
    if (has_come_) seen.seen.push_back({"BOX", X_WP_, Matrix6::Zero(), Vector3::Constant(0.1), 0.0});
    for (const perception::Expectation& one : expected) {
      if (perception::find(seen, one.item) == nullptr) seen.not_seen.push_back(one.item);
    }
    runner_.add({now_.time, Perceived{seen}});
  }
  void acknowledge() override {}

 private:
  static constexpr double kStiffness = 1000.0;              ///< N/m, of the tool's end
  static constexpr double kTable = 0.1;                     ///< m, height of the box's upper face
  static constexpr double kSet = -6.0e4, kNeeded = -2.0e4;  ///< Pa

  static RunnerSettings settings() {
    RunnerSettings one;
    one.guards.exact_settle = one.guards.seal_patience = 0.0;
    one.pressure_needed = kNeeded;
    return one;
  }
  [[nodiscard]] TickReading reading() const { return {now_.time, now_.F_E, now_.pressure_gauge, now_.io.vacuum}; }

  /// One waypoint, and a tick of rest at it: the vacuum has time to be seen.
  void tick() {
    const auto& waypoints = runner_.motion().waypoints;
    if (next_ == waypoints.size()) {
      runner_.arrive(now_.time);
      runner_.rest(now_.time);
      return runner_.finish(now_);
    }
    const motion::Waypoint& waypoint = waypoints[next_];
    now_.time += 0.5;
    jump(waypoint);
    runner_.follow({motion::WaypointIndex(next_), now_.time});
    runner_.check(reading());
    next_ += is_second_ ? 1 : 0;
    is_second_ = !is_second_ && !runner_.has_ended();
    if (runner_.has_ended()) runner_.finish(now_);
  }

  void jump(const motion::Waypoint& waypoint) {
    now_.X_WE = waypoint.X_WE;
    now_.io = waypoint.io;
    const double depth = has_come_ && !is_held_ ? std::max(0.0, kTable - waypoint.X_WE.p.z()) : 0.0;
    if (waypoint.io.vacuum && depth > 0.0) is_held_ = true;
    if (!waypoint.io.vacuum) is_held_ = false;
    now_.pressure_gauge = is_held_ ? kSet : 0.0;
    if (is_held_) X_WP_ = waypoint.X_WE;
    now_.F_E.force = Vector3(0.0, 0.0, is_held_ ? 5.0 : -kStiffness * depth);
  }

  Feedback now_;
  Pose X_WP_;
  MotionRunner runner_{settings()};
  std::size_t next_ = 0;    ///< waypoint
  bool is_second_ = false;  ///< tick at it
  bool has_come_ = false, is_held_ = false;
};

}  // namespace snug::plant::test
