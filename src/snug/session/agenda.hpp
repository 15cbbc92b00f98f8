// Agenda: the items of a session in their order, and those that are under way now.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "snug/session/decisions.hpp"
#include "snug/session/operator.hpp"
#include "snug/session/result.hpp"

namespace snug::session {

/// What is done about one motion that did not come to what was planned.
struct RecoveryTask {
  Trouble trouble = Trouble::None;
  model::ItemIndex culprit;  ///< the box that it is about: the item itself, or one that sticks out or was moved
  int tries = 0;             ///< Situation::tries, of the culprit
  int rounds = 0;            ///< of remedies
  int stops = 0;             ///< protective stops
  int repacked = 0;          ///< other boxes that were packed anew
  int returns = 0;           ///< boxes that were returned to the aligner
  bool was_pressed = false;
  bool ends_unless_moved = false;  ///< of the box that is packed anew now: where nothing moves its tries are used up
};

/// One item under way.
struct ItemTask {
  model::ItemIndex item;
  std::string id;
  double begun = 0.0;                       ///< s, of the plant
  std::optional<Decided> ready;             ///< made while the tool left the item before
  std::optional<planning::Plan> plan;       ///< of the motion that was sent last
  std::size_t stage = 0;                    ///< of the plan's motion
  std::vector<std::optional<Pose>> before;  ///< X_WP of all items when it was sent
  bool replaces_last = false;               ///< the next motion takes the place of the last: the loop closed on the way
  int attempts = 0;                         ///< that were rehearsed
  int sends = 0;                            ///< motions that were sent
  double angle_error = 0.0;                 ///< rad, from its plan, as it was seen last
  std::optional<Remedy> last_remedy;
  std::vector<planning::Tried> tried;              ///< of the last decision that was left to the agent
  std::optional<packing::Placement> asked_place;   ///< that the operator chose, and that is to be planned now
  OperatorOrder asked_by;                          ///< its order
  std::vector<packing::Placement> refused_places;  ///< by the operator
  bool is_held = false;                            ///< by the operator
  std::optional<model::ItemIndex> brings_back;     ///< a box that waited on the bench and is packed now
  std::optional<planning::Room> room;              ///< a move of another box, after which this one has a place
  int rooms = 0;                                   ///< such moves that were begun
  std::optional<planning::Aside> aside;            ///< a box that waits on the bench until this item is done with
  RecoveryTask recovery;
  ItemEnd end = ItemEnd::NoPlace;
  std::string reason;
};

struct Agenda {
  std::vector<model::ItemIndex> order;  ///< as they are to come
  std::size_t next = 0;                 ///< of `order`
  /// Under way: the item that came, a box that it moved, one that this one moved. Work is done on the last.
  std::vector<ItemTask> under_way;
  std::optional<ItemTask> finished;      ///< that was under way last, because of the one that is on top now
  std::vector<model::ItemIndex> packed;  ///< in the order in which they were reported
  int reported = 0;                      ///< items, packed or not
  std::string order_ends;                ///< why an agent that plans the whole sequence left off; empty: it did not
  std::set<model::ItemIndex> left_out;   ///< they stick out and nothing more is done about them
  std::set<model::ItemIndex> returned;   ///< packed before, and returned to the aligner
  std::set<model::ItemIndex> pressed;    ///< from above, since they were sent last

  [[nodiscard]] ItemTask& top() { return under_way.back(); }
  [[nodiscard]] const ItemTask& top() const { return under_way.back(); }
  [[nodiscard]] bool is_under_way(model::ItemIndex item) const;
  /// The item that comes after this one; none: it is the last, or it is packed anew because of another.
  [[nodiscard]] std::optional<model::ItemIndex> follower_of(model::ItemIndex item) const;
};

}  // namespace snug::session
