// ItemSeconds: where the time of an item goes.
#include "snug/session/item_seconds.hpp"

#include <algorithm>
#include <string_view>

namespace snug::session {
namespace {

double& part_of(const motion::Waypoint& waypoint, ItemSeconds& seconds) {
  const std::string_view name = waypoint.name;
  for (const char* prefix : {"Twist", "PreTwist", "RePick", "PreRePick", "PostRePick"}) {
    if (name.starts_with(prefix)) return seconds.regrasp;
  }
  if (name.starts_with("PlaceSlow")) return seconds.push;
  if (name.starts_with("Place")) return seconds.insert;
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
