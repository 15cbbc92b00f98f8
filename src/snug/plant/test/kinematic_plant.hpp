// KinematicPlant: the smallest thing that is a Plant: a tool that jumps, one box on a rigid table. For the contract
// itself.
#pragma once

#include <algorithm>
#include <string>

#include "snug/plant/plant.hpp"

namespace snug::plant::test {

class KinematicPlant final : public Plant {
 public:
  [[nodiscard]] Description describe() const override { return {"kinematic", {}}; }
  [[nodiscard]] Feedback read() override { return now_; }
  [[nodiscard]] bool bring(const std::string& item) override {
    if (item != "BOX" || has_come_) return false;
    has_come_ = true;
    return true;
  }
  void acknowledge() override {}

  using Plant::submit;
  [[nodiscard]] Feedback submit(const Motion& motion, const OnPassing& passing) override {
    now_.peak_force = now_.peak_torque = 0.0;
    now_.end = {EndReason::Refused, -1, 0.0, 0.0, ""};
    now_.times.clear();
    for (const motion::Waypoint& waypoint : motion.waypoints) {
      if (!waypoint.X_WE.p.allFinite() || !waypoint.X_WE.R.allFinite()) return now_;
    }
    now_.times.resize(motion.waypoints.size());
    for (std::size_t i = 0; i < motion.waypoints.size(); ++i) {
      if (!follow(motion.waypoints[i], static_cast<int>(i), motion.guards)) break;
      if (passing.act && static_cast<int>(i) == passing.waypoint && i + 1 < motion.waypoints.size()) passing.act();
    }
    return now_;
  }

  [[nodiscard]] perception::Observation perceive(std::span<const perception::Expectation> expected) override {
    perception::Observation seen;
    seen.time = now_.time;
    if (has_come_) seen.seen.push_back({"BOX", X_WP_, Matrix6::Zero(), Vector3::Constant(0.1), 0.0});
    for (const perception::Expectation& one : expected) {
      if (perception::find(seen, one.item) == nullptr) seen.not_seen.push_back(one.item);
    }
    return seen;
  }

 private:
  static constexpr double kStiffness = 1000.0;              ///< N/m, of the tool's end
  static constexpr double kTable = 0.1;                     ///< m, height of the box's upper face
  static constexpr double kSet = -6.0e4, kNeeded = -2.0e4;  ///< Pa

  bool follow(const motion::Waypoint& waypoint, int index, const Guards& guards) {
    now_.time += 1.0;
    now_.times[static_cast<std::size_t>(index)].moving = 1.0;
    now_.X_WE = waypoint.X_WE;
    now_.io = waypoint.io;
    now_.end = {EndReason::Completed, index, 0.0, 0.0, ""};
    const double depth = has_come_ && !is_held_ ? std::max(0.0, kTable - waypoint.X_WE.p.z()) : 0.0;
    if (waypoint.io.vacuum && depth > 0.0) is_held_ = true;
    if (!waypoint.io.vacuum) is_held_ = false;
    now_.pressure_gauge = is_held_ ? kSet : 0.0;
    if (is_held_) X_WP_ = waypoint.X_WE;
    now_.F_E.force = Vector3(0.0, 0.0, is_held_ ? 5.0 : -kStiffness * depth);
    now_.peak_force = std::max(now_.peak_force, now_.F_E.force.norm());
    if (guards.force && now_.F_E.force.norm() > *guards.force) {
      now_.end = {EndReason::ForceGuard, index, now_.F_E.force.norm(), *guards.force, ""};
    } else if (guards.vacuum && waypoint.io.vacuum && !is_held_) {
      now_.end = {EndReason::NoSeal, index, now_.pressure_gauge, kNeeded, ""};
    }
    return now_.end.reason == EndReason::Completed;
  }

  Feedback now_;
  Pose X_WP_;
  bool has_come_ = false, is_held_ = false;
};

}  // namespace snug::plant::test
