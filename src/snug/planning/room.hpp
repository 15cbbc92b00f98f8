// make_room: a packed box that is to stand elsewhere, so that an item without a place gets one.
#pragma once

#include <optional>

#include "snug/planning/plan.hpp"

namespace snug::planning {

/// Where a packed box waits until the item stands.
struct Aside {
  model::ItemIndex box;
  packing::Placement item;  ///< where the item goes meanwhile
};

/// A packed box moves, and nothing else yet.
struct Room {
  BeliefSnapshot asked;        ///< the belief with the box's place chosen: plan() of it is `plan`
  Plan plan;                   ///< of the box; of one that is put aside: nothing
  std::optional<Aside> aside;  ///< the box is put on the bench first, and back when the item stands
};

/// The move of one box after which the item has a place. It is rehearsed, and so is the item's own motion after it, in
/// the worlds that the move leaves. A box that moves stays on the face that it stands on, and nothing stands on it.
/// Moves are tried by the filling that is expected after them in the end, which has to be larger than without the item
/// by more than `recovery.gain_elsewhere`; one after which the item is pressed in counts less.
/// Where the session ends without the item, more is tried: boxes that are turned over when they move, a box that waits
/// on the bench while the item takes a place that both cannot reach in the other order, and the first of two boxes that
/// move. None: nothing of that succeeds, or the agent does not look ahead. Throws InputError as PlanningWorkspace does.
[[nodiscard]] std::optional<Room> make_room(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                                            PlanningWorkspace& work);

}  // namespace snug::planning
