// SessionEvent: what happened in a session, typed, in the order in which it happened.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "snug/session/result.hpp"
#include "snug/session/state_table.hpp"

namespace snug::session::event {

/// Times are s, of the plant. Items are of SessionStarted::items.

struct SessionStarted {
  std::string sequence, agent, plant;
  std::vector<model::ParcelId> items;
  bool places_are_chosen = false;  ///< by an agent that plans the whole sequence before anything is done
  motion::Tracking tracking;       ///< of the program
  template <class Archive>
  void fields(Archive& a) {
    a("sequence", sequence);
    a("agent", agent);
    a("plant", plant);
    a("items", items);
    a("places_are_chosen", places_are_chosen);
    a("tracking", tracking);
  }
};

/// An agent that plans the whole sequence has decided on one item; `reason`: why it is left out, or empty.
struct DecidedBefore {
  model::ItemIndex item;
  double seconds = 0.0;  ///< wall clock
  bool is_infeasible = false;
  std::string reason;
  template <class Archive>
  void fields(Archive& a) {
    a("item", item);
    a("seconds", seconds);
    a("is_infeasible", is_infeasible);
    a("reason", reason);
  }
};

/// A transition of the state table (state_table.hpp).
struct Stepped {
  double time = 0.0;
  model::ItemIndex item;  ///< on top of the agenda
  State from = State::NextItem;
  Signal signal = Signal::Finished;
  State to = State::NextItem;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("from", from);
    a("signal", signal);
    a("to", to);
  }
};

/// An item is begun; `because_of`: it was packed before and is packed anew because of that one.
struct ItemStarted {
  double time = 0.0;
  model::ItemIndex item;
  std::optional<model::ItemIndex> because_of;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("because_of", because_of);
  }
};

struct ItemBrought {
  double time = 0.0;
  model::ItemIndex item;
  bool is_ahead = false;  ///< while the tool left the item before
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("is_ahead", is_ahead);
  }
};

struct Perceived {
  double time = 0.0;
  int seen = 0;
  std::vector<std::string> not_seen, missing;
  perception::LookFault fault = perception::LookFault::None;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("seen", seen);
    a("not_seen", not_seen);
    a("missing", missing);
    a("fault", fault);
  }
};

/// A plan that is taken: what is tried and why it lost. `waited`: s of wall clock that the robot stood for it.
struct Planned {
  double time = 0.0;
  model::ItemIndex item;
  planning::PlanOutcome outcome = planning::PlanOutcome::NoPlace;
  std::string reason;
  std::vector<planning::Tried> tried;
  int attempts = 0, stops = 0;
  std::optional<packing::Placement> planned;
  skills::Reorientation reorientation = skills::Reorientation::None;
  skills::InsertionSkill skill = skills::InsertionSkill::TopDown;
  int flips = 0, samples = 0;
  double success_rate = 0.0, predicted_success = 0.0;
  planning::AttemptForces predicted;
  double decision_seconds = 0.0, rehearsal_seconds = 0.0, waited = 0.0;
  std::string belief_file;  ///< where the belief was saved; empty: it was not
  std::string hash;         ///< of the plan, where the belief was saved
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("outcome", outcome);
    a("reason", reason);
    a("tried", tried);
    a("attempts", attempts);
    a("stops", stops);
    a("planned", planned);
    a("reorientation", reorientation);
    a("skill", skill);
    a("flips", flips);
    a("samples", samples);
    a("success_rate", success_rate);
    a("predicted_success", predicted_success);
    a("predicted", predicted);
    a("decision_seconds", decision_seconds);
    a("rehearsal_seconds", rehearsal_seconds);
    a("waited", waited);
    a("belief_file", belief_file);
    a("hash", hash);
  }
};

/// A plan that was made ahead and is for another place than where the tool stands.
struct PlanDropped {
  double time = 0.0;
  model::ItemIndex item;
  double waited = 0.0;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("waited", waited);
  }
};

/// The motions of a plan are sent.
struct Sent {
  double time = 0.0;
  model::ItemIndex item;
  double predicted_success = 0.0;
  packing::Placement planned;
  bool replaces_last = false;  ///< planned anew on the way: the loop closed, nothing went wrong
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("predicted_success", predicted_success);
    a("planned", planned);
    a("replaces_last", replaces_last);
  }
};

struct MotionStarted {
  double time = 0.0;
  model::ItemIndex item;  ///< none: the way home
  std::vector<motion::Waypoint> waypoints;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("waypoints", waypoints);
  }
};

struct MotionEnded {
  double time = 0.0;
  model::ItemIndex item;
  plant::End end;
  ItemSeconds seconds;
  double peak_force = 0.0, peak_torque = 0.0;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("end", end);
    a("seconds", seconds);
    a("peak_force", peak_force);
    a("peak_torque", peak_torque);
  }
};

/// What the motions of the plan that was sent last came to.
struct SendEnded {
  model::ItemIndex item;
  plant::End end;
  template <class Archive>
  void fields(Archive& a) {
    a("item", item);
    a("end", end);
  }
};

/// The box where it is now, compared with its plan.
struct Assessed {
  double time = 0.0;
  model::ItemIndex item;
  Pose X_TP;
  double position_error = 0.0, angle_error = 0.0, displacement = 0.0;
  Trouble trouble = Trouble::None;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("X_TP", X_TP);
    a("position_error", position_error);
    a("angle_error", angle_error);
    a("displacement", displacement);
    a("trouble", trouble);
  }
};

/// A trouble and what is done about it. `is_of_motion`: found after a motion for the item.
struct Remedied {
  double time = 0.0;
  model::ItemIndex item;
  Trouble trouble = Trouble::None;
  Remedy remedy = Remedy::None;
  std::string detail;
  bool is_of_motion = false;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("trouble", trouble);
    a("remedy", remedy);
    a("detail", detail);
    a("is_of_motion", is_of_motion);
  }
};

/// Who operates said something; `item`: the one that was to be decided on or to come.
struct Operated {
  double time = 0.0;
  model::ItemIndex item;
  int line = 0;       ///< of the operator's file
  std::string order;  ///< format_operator_order(), with the item
  bool was_followed = true;
  std::string text;  ///< why it was not, or what follows; for people
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("line", line);
    a("order", order);
    a("was_followed", was_followed);
    a("text", text);
  }
};

/// An item is done with; one that was packed anew because of another has no `end` of its own.
struct ItemEnded {
  double time = 0.0;
  model::ItemIndex item;
  ItemEnd end = ItemEnd::NoPlace;
  std::string reason;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("item", item);
    a("end", end);
    a("reason", reason);
  }
};

/// A box that was packed before was packed anew, and was seen (or is believed) there.
struct Repacked {
  model::ItemIndex item;
  packing::Placement planned;
  Pose X_TP;
  std::optional<model::ItemIndex> room_for;  ///< item that has its place because of it; none: of a recovery
  template <class Archive>
  void fields(Archive& a) {
    a("item", item);
    a("planned", planned);
    a("X_TP", X_TP);
    a("room_for", room_for);
  }
};

/// What was packed before is not packed any more.
struct ItemLost {
  model::ItemIndex item;
  ItemEnd end = ItemEnd::Gone;
  std::string reason;
  template <class Archive>
  void fields(Archive& a) {
    a("item", item);
    a("end", end);
    a("reason", reason);
  }
};

/// Where a box of an item that came is believed to be.
struct Standing {
  model::ItemIndex item;
  Pose X_WP;
  Vector3 size;  ///< m, as measured
  template <class Archive>
  void fields(Archive& a) {
    a("item", item);
    a("X_WP", X_WP);
    a("size", size);
  }
};

/// After every item, and in the end.
struct Counted {
  double time = 0.0;
  double planned_percent = 0.0;
  std::vector<ObstacleReport> obstacles;
  std::vector<Standing> boxes;  ///< of the items that are done with
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("planned_percent", planned_percent);
    a("obstacles", obstacles);
    a("boxes", boxes);
  }
};

/// Why no further item comes.
struct Stopped {
  StopReason reason = StopReason::NoItems;
  std::string text;
  template <class Archive>
  void fields(Archive& a) {
    a("reason", reason);
    a("text", text);
  }
};

struct SessionEnded {
  double time = 0.0;
  SessionFailureKind failure = SessionFailureKind::None;
  std::string text;
  template <class Archive>
  void fields(Archive& a) {
    a("time", time);
    a("failure", failure);
    a("text", text);
  }
};

}  // namespace snug::session::event

namespace snug::session {

using SessionEvent = std::variant<event::SessionStarted, event::DecidedBefore, event::Stepped, event::ItemStarted,
                                  event::ItemBrought, event::Perceived, event::Planned, event::PlanDropped, event::Sent,
                                  event::MotionStarted, event::MotionEnded, event::SendEnded, event::Assessed,
                                  event::Remedied, event::Operated, event::ItemEnded, event::Repacked, event::ItemLost,
                                  event::Counted, event::Stopped, event::SessionEnded>;

/// What logs call it: "motion started".
[[nodiscard]] const char* kind_of(const SessionEvent& one);

}  // namespace snug::session
