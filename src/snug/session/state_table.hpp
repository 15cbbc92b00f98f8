// StateTable: the session as states, signals and transitions: data that is executed, printed and checked.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace snug::session {

/// What is being done for the item on top of the agenda.
enum class State {
  NextItem,         ///< takes the next item of the order, or ends
  Bring,            ///< lets the plant bring it
  PerceiveItem,     ///< perceives it where it arrived
  CheckItem,        ///< is it the item that was to come?
  TakeOut,          ///< a packed box is put to the aligner, as the operator says
  Plan,             ///< decides where it goes and by which motion, or takes a plan that was made ahead
  AskOperator,      ///< does who operates want something else than what is planned?
  MakeRoom,         ///< it has no place: another box is to stand elsewhere, so that it gets one
  PutBack,          ///< it has no place: it goes back to the aligner from where it was moved to
  Send,             ///< starts the motion, or its next stage
  Moving,           ///< reads the plant's events
  LookAhead,        ///< the tool leaves: the next item is brought, perceived, and its planning begun
  StageDone,        ///< perceives a box that was let go on the way
  MotionDone,       ///< what the motion came to
  Assess,           ///< perceives and compares with the plan; lets go first where the motion broke off
  Remedy,           ///< chooses what is done about a trouble
  Resume,           ///< acknowledges a stop and sends the rest of the motion
  SetDown,          ///< puts the held box on the bench and perceives
  Release,          ///< lets go where the tool is, and goes up
  PressLevel,       ///< presses on the box from above
  ReturnToAligner,  ///< puts the box back to the aligner and perceives
  Repack,           ///< another box is put on top of the agenda, to be packed anew
  FinishItem,       ///< writes down what became of the item
  ResumeItem,       ///< another box was packed anew: the item below it goes on
  GoHome,           ///< the tool goes to its start
  Done,
};
inline constexpr int kStates = static_cast<int>(State::Done) + 1;
[[nodiscard]] const char* name_of(State state);

/// What came of it.
enum class Signal {
  ItemToBring,
  ItemIsHere,    ///< it was brought while the tool left the one before, and perceived
  ItemIsUnseen,  ///< it was brought ahead, but not perceived well
  OrderDone,     ///< no further item
  Stopped,       ///< the session is to end
  Brought,
  NotBrought,
  Perceived,
  RightItem,
  WrongItem,
  Planned,
  ToBeConfirmed,  ///< it is planned, and there is somebody who operates
  Gone,           ///< the item is not believed to be anywhere
  NoPlace,
  Finished,  ///< this was done, whatever came of it
  Started,
  ToolLeaves,  ///< the box was let go, the tool is on its way to where it waits
  MotionEnded,
  StageEnded,  ///< completed, and another stage follows
  InPlace,     ///< it was seen in its place while the tool left
  ToBeAssessed,
  AsRehearsed,     ///< the box stands where the rehearsal let it go
  NotAsRehearsed,  ///< planned anew from there
  NoTrouble,
  Trouble,
  RoundsUsedUp,
  Accept,  ///< remedies
  Skip,
  Stop,
  PickAgain,    ///< the item itself
  RepackOther,  ///< another box
  Resume,
  SetDown,
  Release,
  PressLevel,
  ReturnToAligner,
  LeaveOther,  ///< another box stays where it is
  ToBePlannedAnew,
  TakenAway,     ///< it stands at the aligner for the last time
  TakeOut,       ///< the operator wants a packed box taken out
  GoOn,          ///< the operator wants nothing else
  AnotherPlace,  ///< the operator chose one
  NextOnAgenda,  ///< it was packed because of another one, which goes on
};
inline constexpr int kSignals = static_cast<int>(Signal::NextOnAgenda) + 1;
[[nodiscard]] const char* name_of(Signal signal);

struct Transition {
  State from;
  Signal signal;
  State to;
  bool operator==(const Transition&) const = default;
};

/// All of them.
[[nodiscard]] std::span<const Transition> transitions();
/// None: the table has no such transition.
[[nodiscard]] std::optional<State> next_state(State from, Signal signal);
/// What a table must not be: a state without an exit, one that cannot be reached, one from which the end cannot be
/// reached, two transitions for the same signal. Empty: none of these.
[[nodiscard]] std::vector<std::string> find_faults(std::span<const Transition> table);
/// The table in Markdown, as docs/session.md has it.
[[nodiscard]] std::string format_table(std::span<const Transition> table);

}  // namespace snug::session
