// AlignerFeed: how a box of the sequence stands at the aligner when the robot comes for it.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::cell {

/// How many quarter turns about the vertical, 0 .. 3, an item stands turned by where the sequence leaves that open: by
/// the aligner's rule from `X_WE_pick`, the waypoint of the pick: the middle of the face that the tool points at is as
/// near to where it touches as can be. 0 where the sequence or the rule leaves no choice.
[[nodiscard]] int choose_quarter(const model::Scenario& scenario, const model::Item& item,
                                 const std::optional<Pose>& X_WE_pick);

/// X_WP of an item at the aligner: in its corner, the axis up that the sequence says, turned as the sequence says or by
/// these quarter turns. The scenario must have an aligner (checked).
[[nodiscard]] Pose pose_at_aligner(const model::Scenario& scenario, const model::Item& item, int quarter);
/// Turned as `choose_quarter` says.
[[nodiscard]] Pose pose_at_aligner(const model::Scenario& scenario, const model::Item& item,
                                   const std::optional<Pose>& X_WE_pick);

/// The waypoint of the pick that a departure toward `row` leads to: where the cup is when the vacuum comes on next.
[[nodiscard]] std::optional<Pose> next_pick(const motion::Program& program, int row);

/// Index of the item that the waypoint is for (motion::fit_of), or -1.
[[nodiscard]] int find_item(const model::Sequence& sequence, const motion::Waypoint& waypoint);

/// The axis of a box that is nearest to vertical, 0 .. 2.
[[nodiscard]] int vertical_axis(const Matrix3& R_WP);
[[nodiscard]] char axis_letter(int axis);

}  // namespace snug::cell
