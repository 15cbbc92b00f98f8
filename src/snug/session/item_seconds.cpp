// ItemSeconds: where the time of an item goes.
#include "snug/session/item_seconds.hpp"

#include <algorithm>

namespace snug::session {
namespace {

double& part_of(const motion::Waypoint& waypoint, ItemSeconds& seconds) {
  switch (waypoint.motion_class) {
    case motion::MotionClass::PreTwist:
    case motion::MotionClass::Twist:
    case motion::MotionClass::TwistDrag:
    case motion::MotionClass::PreRePick:
    case motion::MotionClass::RePick:
    case motion::MotionClass::PostRePick:
      return seconds.regrasp;
    case motion::MotionClass::PlaceSlow:
      return seconds.push;
    case motion::MotionClass::Place:
      return seconds.insert;
    default:
      break;
  }
  return waypoint.io.vacuum ? seconds.carry : seconds.travel;
}

}  // namespace

ItemSeconds& ItemSeconds::operator+=(const ItemSeconds& other) {
  travel += other.travel;
  carry += other.carry;
  regrasp += other.regrasp;
  insert += other.insert;
  push += other.push;
  wait += other.wait;
  return *this;
}

ItemSeconds split_seconds(std::span<const motion::Waypoint> waypoints, std::span<const plant::WaypointTime> times) {
  ItemSeconds seconds;
  for (std::size_t i = 0; i < std::min(waypoints.size(), times.size()); ++i) {
    part_of(waypoints[i], seconds) += times[i].moving;
    seconds.wait += times[i].waiting;
  }
  return seconds;
}

}  // namespace snug::session
