// Run: what a session under way consists of, and what each state of its table does.
#pragma once

#include <optional>

#include "snug/session/agenda.hpp"
#include "snug/session/belief.hpp"
#include "snug/session/decisions.hpp"
#include "snug/session/executor.hpp"
#include "snug/session/internal/operator_desk.hpp"
#include "snug/session/session.hpp"

namespace snug::session::internal {

struct Run {
  const SessionOptions& options;
  EventSink log;
  planning::CellPlan cell;
  Belief belief;
  Executor executor;
  Agenda agenda;
  Decisions decisions;
  OperatorDesk desk;
  std::optional<StopReason> stop;  ///< set: nothing more can be done

  [[nodiscard]] planning::Scene scene() const { return {belief.now(), cell}; }
};

/// Does what the state is for, and says what came of it.
[[nodiscard]] Signal act(State state, Run& run);

// From the order to the motion (item_actions.cpp)
[[nodiscard]] Signal take_next_item(Run& run);
[[nodiscard]] Signal bring_item(Run& run);
[[nodiscard]] Signal perceive_item(Run& run);
[[nodiscard]] Signal check_item(Run& run);
[[nodiscard]] Signal plan_item(Run& run);
[[nodiscard]] Signal make_room(Run& run);
[[nodiscard]] Signal put_back(Run& run);
[[nodiscard]] Signal finish_item(Run& run);
[[nodiscard]] Signal resume_item(Run& run);
[[nodiscard]] Signal go_home(Run& run);
// Who operates (operator_actions.cpp)
[[nodiscard]] Signal ask_operator(Run& run);
[[nodiscard]] Signal take_out(Run& run);
/// The place that the operator chose cannot be.
void refuse_place(Run& run, const std::string& why);
// The motion (motion_actions.cpp)
[[nodiscard]] Signal send_motion(Run& run);
[[nodiscard]] Signal follow_motion(Run& run);
[[nodiscard]] Signal look_ahead(Run& run);
[[nodiscard]] Signal end_motion(Run& run);
[[nodiscard]] Signal perceive_stage(Run& run);
// What went wrong (recovery_actions.cpp)
[[nodiscard]] Signal assess_motion(Run& run);
[[nodiscard]] Signal choose(Run& run);
[[nodiscard]] Signal resume(Run& run);
[[nodiscard]] Signal set_down(Run& run);
[[nodiscard]] Signal release(Run& run);
[[nodiscard]] Signal press_level(Run& run);
[[nodiscard]] Signal return_to_aligner(Run& run);
[[nodiscard]] Signal repack(Run& run);

// Parts that several of these have in common

/// One observation, with what is done about pictures that tell nothing; what it told is believed. `stays`: the tool
/// does not leave for a picture that something blocks.
void perceive(Run& run, bool stays = false);
/// What one observation told. `own`: the item that it is taken for.
void believe(Run& run, const perception::Observation& seen, model::ItemIndex own);
/// The item on top compared with `planned`; said in the log.
[[nodiscard]] Trouble assess_item(Run& run, const packing::Placement& planned);
/// Vacuum off, the tool straight up. `item`: that may hang from it.
void retreat(Run& run, model::ItemIndex item);
/// The tool presses on the box from above.
void press_on(Run& run, model::ItemIndex item);
/// The tool to its start.
void move_home(Run& run);
/// A box to the aligner: held as it hangs for the plan of the item on top, or picked where it lies.
void send_to_aligner(Run& run, model::ItemIndex item, bool may_hang_as_planned);
/// The robot as the session before left it (SessionOptions::takes_over), brought to where an item can begin. Throws
/// InputError where a box hangs from the cup that is not seen, or that cannot be put down.
void take_over(Run& run);
/// Where the culprit lies now is where it is to be from now on.
void forget_displacement(Run& run);
/// A trouble of the item on top and its remedy, said in the log.
void note_remedy(Run& run, Trouble trouble, Remedy remedy, std::string detail, bool is_of_motion);
/// An item is done with: packed, skipped, or lost.
void account_for(Run& run, model::ItemIndex item, ItemEnd end);
void end_item(ItemTask& task, ItemEnd end, std::string reason);
/// It lies where it was left, or is gone.
void give_up(Run& run, Trouble trouble);
/// No motion is planned for the item on top any more: one that was moved before stays where it lies.
void leave(Run& run);
/// No further item comes. The first reason stays.
void stop(Run& run, StopReason reason, std::string text = {});

}  // namespace snug::session::internal
