// Reach: whether the scenario's robot can bring a box to a place, by its joints alone.
#pragma once

#include <functional>
#include <span>

#include "snug/motion/way.hpp"
#include "snug/skills/item_plan.hpp"

namespace snug::planning {

/// Whether the scenario's robot can follow a way of the tool: from the branch of its inverse, within joint limits, that
/// is nearest to its posture at the start. Of a way to where it begins: whether it reaches that pose. Empty: all.
using ToolReach = std::function<bool(const motion::Way&)>;
/// Empty without a robot, and where its file is not there.
[[nodiscard]] ToolReach make_tool_reach(const model::Scenario& scenario);

/// Of fast motions: every way to waypoints that touch nothing can be followed from where the one before ends, the first
/// from `before`. Of others nothing is asked.
[[nodiscard]] bool can_follow(const ToolReach& reaches, const skills::CellLayout& layout,
                              const motion::Waypoint& before, std::span<const motion::Waypoint> waypoints);

/// Says of a placement whether the tool poses over it, where the box is let go and where it is carried in, have a
/// branch of the arm's inverse within its joint limits. The tool is asked for at the layout's neutral yaw: it never is
/// more than a quarter turn from that, and turns about its last joint. Ways between poses and the links' surroundings
/// are not checked: the simulated arm and `snug check` do that. Empty without a robot, and where its file is not
/// there.
[[nodiscard]] std::function<bool(const packing::Placement&)> make_reach(const model::Scenario& scenario,
                                                                        const skills::CellLayout& layout,
                                                                        const model::Sequence& sequence);

}  // namespace snug::planning
