// Event: what a plant says of its own: each is a small value, in the order of time, said once.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "snug/plant/plant.hpp"

namespace snug::plant {

/// The tool has left the waypoint for the next one. Not said of the last one, nor in the tick that ends the motion.
struct WaypointPassed {
  motion::WaypointIndex waypoint;
  bool operator==(const WaypointPassed&) const = default;
};
/// The vacuum is deep enough: something hangs from the cup.
struct VacuumBuilt {
  double pressure_gauge = 0.0;  ///< Pa
  bool operator==(const VacuumBuilt&) const = default;
};
/// It was there, is still commanded, and broke down; whether it is guarded or not.
struct VacuumDropped {
  double pressure_gauge = 0.0;  ///< Pa
  bool operator==(const VacuumDropped&) const = default;
};
/// A guard of the motion (ForceGuard, HoldGuard) stops the tool; its MotionEnded follows.
struct GuardTripped {
  End end;
  bool operator==(const GuardTripped&) const = default;
};
/// The robot stopped itself (ProtectiveStop), or the plant failed (Fault); where a motion is under way its MotionEnded
/// follows.
struct FaultRaised {
  EndReason reason = EndReason::Fault;
  std::string where;
  bool operator==(const FaultRaised&) const = default;
};
struct MotionEnded {
  Feedback feedback;  ///< when the tool stood; `end` says how
  bool operator==(const MotionEnded&) const = default;
};
struct ItemArrived {
  model::ParcelId item;
  bool operator==(const ItemArrived&) const = default;
};
struct Perceived {
  perception::Observation observation;
  bool operator==(const Perceived&) const = default;
};

struct Event {
  double time = 0.0;  ///< s, of the plant
  std::variant<WaypointPassed, VacuumBuilt, VacuumDropped, GuardTripped, FaultRaised, MotionEnded, ItemArrived,
               Perceived>
      what;
  bool operator==(const Event&) const = default;
};

/// nullptr when it is another kind.
template <class Kind>
[[nodiscard]] const Kind* get(const Event& event) {
  return std::get_if<Kind>(&event.what);
}

}  // namespace snug::plant
