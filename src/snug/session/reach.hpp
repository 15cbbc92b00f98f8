// Reach: whether the scenario's robot can bring a box to a place, by its joints alone.
#pragma once

#include <functional>

#include "snug/session/item_plan.hpp"

namespace snug::session {

/// Says of a tool pose whether the scenario's robot has a branch of its inverse within joint limits there. Empty
/// without a robot, and where its file is not there.
[[nodiscard]] std::function<bool(const Pose& X_WE)> make_tool_reach(const model::Scenario& scenario);

/// Says of a placement whether the tool poses over it, where the box is let go and where it is carried in, have a
/// branch of the arm's inverse within its joint limits. The tool is asked for at the layout's neutral yaw: it never is
/// more than a quarter turn from that, and turns about its last joint. Ways between poses and the links' surroundings
/// are not looked at: the simulated arm and `snug check` do that. Empty without a robot, and where its file is not
/// there.
[[nodiscard]] std::function<bool(const packing::Placement&)> make_reach(const model::Scenario& scenario,
                                                                        const CellLayout& layout,
                                                                        const model::Sequence& sequence);

}  // namespace snug::session
