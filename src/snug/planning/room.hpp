// make_room: a packed box that is to stand elsewhere, so that an item without a place gets one.
#pragma once

#include <optional>

#include "snug/planning/plan.hpp"

namespace snug::planning {

/// A packed box moves.
struct Room {
  BeliefSnapshot asked;  ///< the belief with the box's place chosen: plan() of it is `plan`
  Plan plan;             ///< of the box
};

/// The move of one box after which the item has a place. It is rehearsed, and so is the item's own motion after it, in
/// the worlds that the move leaves. A box that moves stays on the face that it stands on, and nothing stands on it. Of
/// all moves the one after which most filling is expected in the end, and more than `recovery.gain_elsewhere` more than
/// without the item; none: there is no such move.
[[nodiscard]] std::optional<Room> make_room(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                                            PlanningWorkspace& work);

}  // namespace snug::planning
