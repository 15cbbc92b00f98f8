// StateTable: the session as states, signals and transitions: data that is executed, printed and checked.
#include "snug/session/state_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace snug::session {
namespace {

constexpr std::array kTransitions{
    Transition{State::NextItem, Signal::ItemToBring, State::Bring},
    Transition{State::NextItem, Signal::TakeOut, State::TakeOut},
    Transition{State::NextItem, Signal::ItemIsHere, State::CheckItem},
    Transition{State::NextItem, Signal::ItemIsUnseen, State::PerceiveItem},
    Transition{State::NextItem, Signal::OrderDone, State::GoHome},
    Transition{State::NextItem, Signal::Stopped, State::GoHome},
    Transition{State::TakeOut, Signal::Finished, State::Bring},
    Transition{State::Bring, Signal::Brought, State::PerceiveItem},
    Transition{State::Bring, Signal::NotBrought, State::FinishItem},
    Transition{State::PerceiveItem, Signal::Perceived, State::CheckItem},
    Transition{State::PerceiveItem, Signal::Stopped, State::FinishItem},
    Transition{State::CheckItem, Signal::RightItem, State::Plan},
    Transition{State::CheckItem, Signal::WrongItem, State::FinishItem},
    Transition{State::Plan, Signal::Planned, State::Send},
    Transition{State::Plan, Signal::ToBeConfirmed, State::AskOperator},
    Transition{State::Plan, Signal::Gone, State::FinishItem},
    Transition{State::Plan, Signal::NoPlace, State::MakeRoom},
    Transition{State::Plan, Signal::Stopped, State::FinishItem},
    Transition{State::AskOperator, Signal::GoOn, State::Send},
    Transition{State::AskOperator, Signal::AnotherPlace, State::Plan},
    Transition{State::AskOperator, Signal::Skip, State::PutBack},
    Transition{State::AskOperator, Signal::Stopped, State::FinishItem},
    Transition{State::MakeRoom, Signal::Started, State::Plan},
    Transition{State::MakeRoom, Signal::ToBePlannedAnew, State::Plan},
    Transition{State::MakeRoom, Signal::NoPlace, State::PutBack},
    Transition{State::PutBack, Signal::Finished, State::FinishItem},
    Transition{State::Send, Signal::Started, State::Moving},
    Transition{State::Moving, Signal::ToolLeaves, State::LookAhead},
    Transition{State::Moving, Signal::MotionEnded, State::MotionDone},
    Transition{State::LookAhead, Signal::Finished, State::Moving},
    Transition{State::MotionDone, Signal::StageEnded, State::StageDone},
    Transition{State::MotionDone, Signal::InPlace, State::FinishItem},
    Transition{State::MotionDone, Signal::ToBeAssessed, State::Assess},
    Transition{State::StageDone, Signal::AsRehearsed, State::Send},
    Transition{State::StageDone, Signal::NotAsRehearsed, State::Plan},
    Transition{State::StageDone, Signal::RoundsUsedUp, State::FinishItem},
    Transition{State::Assess, Signal::NoTrouble, State::FinishItem},
    Transition{State::Assess, Signal::Trouble, State::Remedy},
    Transition{State::Assess, Signal::RoundsUsedUp, State::FinishItem},
    Transition{State::Remedy, Signal::Accept, State::FinishItem},
    Transition{State::Remedy, Signal::Skip, State::FinishItem},
    Transition{State::Remedy, Signal::Stop, State::FinishItem},
    Transition{State::Remedy, Signal::PickAgain, State::Plan},
    Transition{State::Remedy, Signal::RepackOther, State::Repack},
    Transition{State::Remedy, Signal::Resume, State::Resume},
    Transition{State::Remedy, Signal::SetDown, State::SetDown},
    Transition{State::Remedy, Signal::Release, State::Release},
    Transition{State::Remedy, Signal::PressLevel, State::PressLevel},
    Transition{State::Remedy, Signal::ReturnToAligner, State::ReturnToAligner},
    Transition{State::Remedy, Signal::LeaveOther, State::Assess},
    Transition{State::Resume, Signal::Finished, State::Assess},
    Transition{State::SetDown, Signal::ToBePlannedAnew, State::Plan},
    Transition{State::SetDown, Signal::Finished, State::Assess},
    Transition{State::Release, Signal::Finished, State::Assess},
    Transition{State::PressLevel, Signal::Finished, State::Assess},
    Transition{State::ReturnToAligner, Signal::Finished, State::Assess},
    Transition{State::ReturnToAligner, Signal::ToBePlannedAnew, State::Plan},
    Transition{State::ReturnToAligner, Signal::RepackOther, State::Repack},
    Transition{State::ReturnToAligner, Signal::TakenAway, State::FinishItem},
    Transition{State::Repack, Signal::Started, State::Plan},
    Transition{State::FinishItem, Signal::Finished, State::NextItem},
    Transition{State::FinishItem, Signal::NextOnAgenda, State::ResumeItem},
    Transition{State::FinishItem, Signal::RepackOther, State::Repack},
    Transition{State::ResumeItem, Signal::Finished, State::Assess},
    Transition{State::ResumeItem, Signal::ToBePlannedAnew, State::Plan},
    Transition{State::ResumeItem, Signal::InPlace, State::FinishItem},
    Transition{State::GoHome, Signal::Finished, State::Done},
};

std::vector<bool> reached_from(std::span<const Transition> table, State start, bool backwards) {
  std::vector<bool> reached(kStates, false);
  reached[static_cast<std::size_t>(start)] = true;
  for (int round = 0; round < kStates; ++round) {
    for (const Transition& one : table) {
      const auto from = static_cast<std::size_t>(backwards ? one.to : one.from);
      const auto to = static_cast<std::size_t>(backwards ? one.from : one.to);
      if (reached[from]) reached[to] = true;
    }
  }
  return reached;
}

}  // namespace

const char* name_of(State state) {
  switch (state) {
    case State::NextItem:
      return "next item";
    case State::Bring:
      return "bring";
    case State::PerceiveItem:
      return "perceive item";
    case State::CheckItem:
      return "check item";
    case State::TakeOut:
      return "take out";
    case State::Plan:
      return "plan";
    case State::AskOperator:
      return "ask operator";
    case State::MakeRoom:
      return "make room";
    case State::PutBack:
      return "put back";
    case State::Send:
      return "send";
    case State::Moving:
      return "moving";
    case State::LookAhead:
      return "look ahead";
    case State::StageDone:
      return "stage done";
    case State::MotionDone:
      return "motion done";
    case State::Assess:
      return "assess";
    case State::Remedy:
      return "remedy";
    case State::Resume:
      return "resume";
    case State::SetDown:
      return "set down";
    case State::Release:
      return "release";
    case State::PressLevel:
      return "press level";
    case State::ReturnToAligner:
      return "return to aligner";
    case State::Repack:
      return "repack";
    case State::FinishItem:
      return "finish item";
    case State::ResumeItem:
      return "resume item";
    case State::GoHome:
      return "go home";
    case State::Done:
      return "done";
  }
  return "";
}

const char* name_of(Signal signal) {
  static constexpr std::array<const char*, kSignals> kNames{"item to bring",
                                                            "item is here",
                                                            "item is unseen",
                                                            "order done",
                                                            "stopped",
                                                            "brought",
                                                            "not brought",
                                                            "perceived",
                                                            "right item",
                                                            "wrong item",
                                                            "planned",
                                                            "to be confirmed",
                                                            "gone",
                                                            "no place",
                                                            "finished",
                                                            "started",
                                                            "tool leaves",
                                                            "motion ended",
                                                            "stage ended",
                                                            "in place",
                                                            "to be assessed",
                                                            "as rehearsed",
                                                            "not as rehearsed",
                                                            "no trouble",
                                                            "trouble",
                                                            "rounds used up",
                                                            "accept",
                                                            "skip",
                                                            "stop",
                                                            "pick again",
                                                            "repack other",
                                                            "resume",
                                                            "set down",
                                                            "release",
                                                            "press level",
                                                            "return to aligner",
                                                            "leave other",
                                                            "to be planned anew",
                                                            "taken away",
                                                            "take out",
                                                            "go on",
                                                            "another place",
                                                            "next on agenda"};
  return kNames[static_cast<std::size_t>(signal)];
}

std::span<const Transition> transitions() { return kTransitions; }

std::optional<State> next_state(State from, Signal signal) {
  const auto found = std::ranges::find_if(
      kTransitions, [&](const Transition& one) { return one.from == from && one.signal == signal; });
  return found == kTransitions.end() ? std::nullopt : std::optional<State>(found->to);
}

std::vector<std::string> find_faults(std::span<const Transition> table) {
  std::vector<std::string> faults;
  const std::vector<bool> reached = reached_from(table, State::NextItem, false);
  const std::vector<bool> ends = reached_from(table, State::Done, true);
  for (int i = 0; i < kStates; ++i) {
    const auto state = static_cast<State>(i);
    const bool has_exit = std::ranges::find(table, state, &Transition::from) != table.end();
    if (!has_exit && state != State::Done) faults.push_back(fmt::format("'{}' has no exit", name_of(state)));
    if (has_exit && state == State::Done) faults.push_back(fmt::format("'{}' has an exit", name_of(state)));
    if (!reached[static_cast<std::size_t>(i)]) faults.push_back(fmt::format("'{}' is not reached", name_of(state)));
    if (!ends[static_cast<std::size_t>(i)]) faults.push_back(fmt::format("'{}' does not end", name_of(state)));
  }
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto rest = table.subspan(i + 1);
    const bool is_twice = std::ranges::any_of(
        rest, [&](const Transition& one) { return one.from == table[i].from && one.signal == table[i].signal; });
    if (is_twice) {
      faults.push_back(fmt::format("'{}' has '{}' twice", name_of(table[i].from), name_of(table[i].signal)));
    }
  }
  return faults;
}

std::string format_table(std::span<const Transition> table) {
  std::string text = "| state | signal | next |\n|---|---|---|\n";
  const Transition* before = nullptr;
  for (const Transition& one : table) {
    const bool is_same = before != nullptr && before->from == one.from;
    text += fmt::format("| {} | {} | {} |\n", is_same ? "" : name_of(one.from), name_of(one.signal), name_of(one.to));
    before = &one;
  }
  return text;
}

}  // namespace snug::session
