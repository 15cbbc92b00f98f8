// Unwinding: rows in between that keep a robot's wrist from winding up and its tool from its own base.
#pragma once

#include <optional>
#include <vector>

#include "snug/motion/way.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::skills {

/// What waypoints in between keep from winding up.
struct Unwinding {
  double neutral_yaw = 0.0;                                ///< rad, of the tool
  double sure_turn = settings::TravelParams().sure_turn;   ///< rad
  bool on_the_way = false;                                 ///< it is turned while it travels
  std::optional<motion::PanAxis> pan_axis = std::nullopt;  ///< around which ways go
};

/// Rows say where the tool shall be and not which way it turns: the shorter one. Where that would take it to the far
/// side of `neutral_yaw`, or could because the turn is nearly half a turn, rows are put in between that turn it on the
/// place over the neutral side, with the switches of the row before and its variant followed by "_turn". So the yaw
/// never leaves (neutral - pi, neutral + pi], however long the program. `before`: the row before the first of `rows`.
/// Those on the way have the switches of the row that they lead to. Where ways go around the robot's first axis it is
/// the turn beyond the way's own that counts.
[[nodiscard]] std::vector<motion::Waypoint> with_turns(const motion::Waypoint& before,
                                                       const std::vector<motion::Waypoint>& rows,
                                                       const Unwinding& unwinding);

/// Straight ways of a tool that points down, longer than `least` [m] and nearer than that to the robot's first axis at
/// `p_WB`, get a row in between that leads around it, `room` [m] away, at the height of the higher end. Its name is
/// that of the row before, and "_around". There the tool would meet the upper arm, and the first joints would have to
/// turn fast.
[[nodiscard]] std::vector<motion::Waypoint> with_detours(const motion::Waypoint& before,
                                                         const std::vector<motion::Waypoint>& rows, const Vector3& p_WB,
                                                         double least, double room);

}  // namespace snug::skills
