// The state table: it has no dead ends, the docs have the same one, and sessions do not leave it.
#include "snug/session/state_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "snug/core/read_file.hpp"
#include "snug/session/recovery.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

TEST(StateTable, HasNoDeadEndsAndNothingTwice) { EXPECT_TRUE(find_faults(transitions()).empty()); }

TEST(StateTable, FindsEachKindOfFault) {
  const auto all = transitions();
  const auto faults_of = [](std::vector<Transition> table) {
    std::string text;
    for (const std::string& fault : find_faults(table)) text += fault + "; ";
    return text;
  };
  std::vector<Transition> table(all.begin(), all.end());
  std::erase_if(table, [](const Transition& one) { return one.from == State::Resume; });
  EXPECT_EQ(faults_of(table), "'resume' has no exit; 'resume' does not end; ");
  table.assign(all.begin(), all.end());
  std::erase_if(table, [](const Transition& one) { return one.to == State::PressLevel; });
  EXPECT_EQ(faults_of(table), "'press level' is not reached; ");
  table.assign(all.begin(), all.end());
  table.push_back(table.front());
  EXPECT_EQ(faults_of(table), "'next item' has 'item to bring' twice; ");
  table.assign(all.begin(), all.end());
  table.push_back({State::Done, Signal::Finished, State::NextItem});
  EXPECT_EQ(faults_of(table), "'done' has an exit; ");
}

/// Whatever situation, the remedy that is chosen is a signal of the table, or one of pictures.
TEST(StateTable, HasATransitionForEveryRemedy) {
  std::set<Signal> signals;
  for (const Transition& one : transitions()) {
    if (one.from == State::Remedy) signals.insert(one.signal);
  }
  for (int i = 0; i <= static_cast<int>(Remedy::Stop); ++i) {
    const std::string name = name_of(static_cast<Remedy>(i));
    const bool is_of_pictures = name == "perceive again" || name == "move away" || name == "believe" || name == "none";
    const bool is_signal = std::ranges::any_of(signals, [&](Signal one) { return std::string(name_of(one)) == name; });
    EXPECT_NE(is_signal, is_of_pictures) << name;
  }
}

TEST(StateTable, StatesAndSignalsHaveNamesOfTheirOwn) {
  std::set<std::string> states, signals;
  for (int i = 0; i < kStates; ++i) states.insert(name_of(static_cast<State>(i)));
  for (int i = 0; i < kSignals; ++i) signals.insert(name_of(static_cast<Signal>(i)));
  EXPECT_EQ(states.size(), static_cast<std::size_t>(kStates));
  EXPECT_EQ(signals.size(), static_cast<std::size_t>(kSignals));
  EXPECT_FALSE(states.contains("") || signals.contains(""));
}

TEST(StateTable, EverySignalIsOfSomeTransition) {
  for (int i = 0; i < kSignals; ++i) {
    const auto signal = static_cast<Signal>(i);
    EXPECT_TRUE(std::ranges::any_of(transitions(), [&](const Transition& one) { return one.signal == signal; }))
        << name_of(signal);
  }
}

TEST(StateTable, IsTheOneOfTheDocs) {
  const std::string docs = read_file(SNUG_SOURCE_DIR "/docs/session.md", "the docs");
  EXPECT_NE(docs.find(format_table(transitions())), std::string::npos) << "docs/session.md has to have this table:\n"
                                                                       << format_table(transitions());
}

/// Motions that end in all ways, one after the other: the path of every session follows the table from its first state
/// to its last, and all paths together take most of it.
TEST(StateTable, SessionsFollowItFromBeginToEnd) {
  std::set<std::pair<State, Signal>> taken;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    ScriptedPlant plant;
    plant.passes = seed % 2 == 0;
    const auto reason = [&] { return static_cast<plant::EndReason>(rng.index(7)); };
    for (int i = 0; i < 6; ++i) plant.ends.push_back(rng.uniform() < 0.5 ? plant::EndReason::Completed : reason());
    plant.happens = [&](int) {
      const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
      for (const char* id : {"BOX027", "BOX028"}) {
        const Vector3 at(rng.uniform(-0.1, 0.1), rng.uniform(-0.2, 0.2), rng.uniform(0.05, 0.3));
        const Matrix3 R = exp_rotation(Vector3(rng.uniform() < 0.3 ? 0.6 : 0.0, 0.0, 0.0));
        plant.visible[id] = {X_WT.R * R, X_WT.p + at};
        if (rng.uniform() < 0.5) plant.visible.erase(id);
      }
    };
    State state = State::NextItem;
    SessionOptions options = quick_options();
    options.log = [&](const SessionEvent& one) {
      const auto* step = std::get_if<event::Stepped>(&one);
      if (step == nullptr) return;
      EXPECT_EQ(step->from, state);
      EXPECT_EQ(next_state(step->from, step->signal), step->to);
      state = step->to;
      taken.emplace(step->from, step->signal);
    };
    const SessionResult result = session::pack(two_boxes(), "1", options, plant);
    EXPECT_EQ(state, State::Done);
    EXPECT_LE(result.items.size(), 2U);
  }
  EXPECT_GT(taken.size(), 25U);
}

}  // namespace
}  // namespace snug::session
