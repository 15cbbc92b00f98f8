// Unwinding: rows in between that keep a robot's wrist from winding up and its tool from its own base.
#pragma once

#include <optional>
#include <vector>

#include "snug/motion/waypoint.hpp"

namespace snug::skills {

/// Rows say where the tool shall be and not which way it turns: the shorter one. Where that would take it to the far
/// side of `neutral_yaw`, or could because the turn is nearly half a turn, rows are put in between that turn it on the
/// place over the neutral side, with the switches of the row before and its variant followed by "_turn". So the yaw
/// never leaves (neutral - pi, neutral + pi], however long the program. `before`: the row before the first of `rows`.
/// `on_the_way`: they turn it while it travels, with the switches of the row that they lead to. Where ways go around
/// the robot's first axis at `p_WB` (motion::Way) it is the turn beyond the way's own that counts.
[[nodiscard]] std::vector<motion::Waypoint> with_turns(const motion::Waypoint& before,
                                                       const std::vector<motion::Waypoint>& rows, double neutral_yaw,
                                                       bool on_the_way = false,
                                                       const std::optional<Vector3>& p_WB = std::nullopt);

/// Straight ways of a tool that points down, longer than `least` [m] and nearer than that to the robot's first axis at
/// `p_WB`, get a row in between that leads around it, `room` [m] away, at the height of the higher end. Its name is
/// that of the row before, and "_around". There the tool would meet the upper arm, and the first joints would have to
/// turn fast.
[[nodiscard]] std::vector<motion::Waypoint> with_detours(const motion::Waypoint& before,
                                                         const std::vector<motion::Waypoint>& rows, const Vector3& p_WB,
                                                         double least, double room);

}  // namespace snug::skills
