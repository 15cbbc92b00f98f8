// The table of remedies as a whole: what it never says, over every situation that there can be.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <set>
#include <string>

#include "snug/session/recovery.hpp"
#include "snug/session/session.hpp"

namespace snug::session {
namespace {

const settings::RecoverySettings kRules;

/// Every trouble with every combination of what may be, tries, stops, pictures and gains: 1.3 million.
void for_every_situation(const std::function<void(const Situation&, Remedy)>& expect) {
  constexpr std::array kFlags{&Situation::is_held,        &Situation::can_set_down,  &Situation::can_return,
                              &Situation::fits,           &Situation::leans,         &Situation::lies_turned,
                              &Situation::lies_on_others, &Situation::can_be_picked, &Situation::was_pressed};
  for (int trouble = 0; trouble <= static_cast<int>(Trouble::PlantFault); ++trouble) {
    for (unsigned flags = 0; flags < (1U << kFlags.size()); ++flags) {
      for (const int tries : {1, kRules.most_tries - 1, kRules.most_tries, kRules.most_tries + 1}) {
        for (const int count : {1, 2, kRules.most_stops, kRules.most_stops + 1}) {
          for (const double gain : {-5.0, kRules.gain_elsewhere, kRules.gain_elsewhere + 0.01}) {
            Situation at;
            at.trouble = static_cast<Trouble>(trouble);
            for (std::size_t i = 0; i < kFlags.size(); ++i) at.*kFlags[i] = ((flags >> i) & 1U) != 0U;
            at.tries = tries;
            at.stops = at.pictures = count;
            at.gain_elsewhere = gain;
            expect(at, choose_remedy(at, kRules));
          }
        }
      }
    }
  }
}

TEST(RemedyTable, AsksForNothingThatCannotBeDone) {
  int wrong = 0;
  for_every_situation([&](const Situation& at, Remedy remedy) {
    switch (remedy) {
      case Remedy::PickAgain:
        wrong += !at.can_be_picked ? 1 : 0;
        break;
      case Remedy::ReturnToAligner:
        wrong += !at.can_return ? 1 : 0;
        break;
      case Remedy::SetDown:
        wrong += !at.is_held || !at.can_set_down ? 1 : 0;
        break;
      case Remedy::Resume:
        wrong += !at.is_held ? 1 : 0;
        break;
      case Remedy::MoveAway:
        wrong += at.is_held ? 1 : 0;
        break;
      case Remedy::Accept:
        wrong += !at.fits ? 1 : 0;
        break;
      default:
        break;
    }
  });
  EXPECT_EQ(wrong, 0);
}

/// What costs a try is not asked for when none is left, a press not twice, and a stop is gone on from once.
TEST(RemedyTable, DoesNotGoOnForEver) {
  int wrong = 0;
  for_every_situation([&](const Situation& at, Remedy remedy) {
    const bool has_tries = at.tries < kRules.most_tries;
    if (remedy == Remedy::PickAgain || remedy == Remedy::SetDown) wrong += has_tries ? 0 : 1;
    if (remedy == Remedy::PressLevel) wrong += at.was_pressed ? 1 : 0;
    if (remedy == Remedy::Resume) wrong += at.stops == 1 ? 0 : 1;
    if (remedy == Remedy::PerceiveAgain || remedy == Remedy::MoveAway)
      wrong += at.pictures < kRules.most_pictures ? 0 : 1;
  });
  EXPECT_EQ(wrong, 0);
}

TEST(RemedyTable, EndsTheSessionForTheFiveReasonsAloneThatSayThatItCannotGoOn) {
  int wrong = 0;
  for_every_situation([&](const Situation& at, Remedy remedy) {
    const bool must_stop =
        at.trouble == Trouble::PlantFault || at.trouble == Trouble::Cancelled ||
        (at.trouble == Trouble::ProtectiveStop && at.stops > kRules.most_stops) ||
        ((at.trouble == Trouble::ViewBlocked || at.trouble == Trouble::NoFrame) && at.pictures >= kRules.most_pictures);
    wrong += (remedy == Remedy::Stop) == must_stop ? 0 : 1;
  });
  EXPECT_EQ(wrong, 0);
}

TEST(RemedyTable, DoesNothingAboutNoTroubleAndSomethingAboutEachOther) {
  int wrong = 0;
  for_every_situation([&](const Situation& at, Remedy remedy) {
    wrong += (remedy == Remedy::None) == (at.trouble == Trouble::None) ? 0 : 1;
  });
  EXPECT_EQ(wrong, 0);
}

/// A box that fits is not worse off where more may be done about it.
TEST(RemedyTable, ABoxThatFitsIsNeverLeftOrTakenAway) {
  int wrong = 0;
  for_every_situation([&](const Situation& at, Remedy remedy) {
    const bool lies_there = at.trouble == Trouble::OffPlace || at.trouble == Trouble::NeighbourMoved ||
                            at.trouble == Trouble::NoSeal || at.trouble == Trouble::VacuumLost;
    if (lies_there && at.fits) wrong += remedy == Remedy::Skip ? 1 : 0;
    const bool is_worth_it = at.lies_turned || at.gain_elsewhere > kRules.gain_elsewhere;
    const bool leans = at.trouble == Trouble::NeighbourMoved && at.leans;
    if (lies_there && at.fits && !is_worth_it && !leans) wrong += remedy == Remedy::Accept ? 0 : 1;
    // A neighbour that leans stays so where nothing else can be done alone.
    const bool may_move = at.tries < kRules.most_tries && (at.can_be_picked || at.can_return);
    if (leans && at.fits) wrong += (remedy == Remedy::Accept) == (at.was_pressed && !may_move) ? 0 : 1;
  });
  EXPECT_EQ(wrong, 0);
}

template <class Enum, class Name>
void expect_names(Enum last, Name name) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    const std::string one = name(static_cast<Enum>(i));
    EXPECT_FALSE(one.empty()) << i;
    EXPECT_TRUE(names.insert(one).second) << one << " twice";
    EXPECT_EQ(one.find_first_not_of("abcdefghijklmnopqrstuvwxyz "), std::string::npos) << one;
  }
}

TEST(SessionWords, EveryValueHasANameOfItsOwn) {
  expect_names(Trouble::PlantFault, [](Trouble one) { return name_of(one); });
  expect_names(Remedy::Stop, [](Remedy one) { return name_of(one); });
  expect_names(ItemEnd::Rejected, [](ItemEnd one) { return name_of(one); });
  expect_names(planning::AttemptFailure::SentBefore, [](planning::AttemptFailure one) { return name_of(one); });
  expect_names(StopReason::Interrupted, [](StopReason one) { return name_of(one); });
  expect_names(SessionFailureKind::PlantLost, [](SessionFailureKind one) { return name_of(one); });
  expect_names(planning::Location::Elsewhere, [](planning::Location one) { return name_of(one); });
}

TEST(SessionWords, AnItemSaysHowItEndedAndWhyUnlessThatIsTheSame) {
  ItemReport item;
  item.end = ItemEnd::NoPlace;
  item.reason = "no space left";
  EXPECT_EQ(describe(item), "no place: no space left");
  item.reason = "no place";
  EXPECT_EQ(describe(item), "no place");
  item.reason.clear();
  item.end = ItemEnd::Placed;
  EXPECT_EQ(describe(item), "placed");
  EXPECT_TRUE(item.is_packed());
  item.end = ItemEnd::Accepted;
  EXPECT_TRUE(item.is_packed());
  item.end = ItemEnd::Rejected;
  EXPECT_FALSE(item.is_packed());
  item.end = ItemEnd::Left;
  EXPECT_FALSE(item.is_packed());
  SessionResult result;
  result.items.assign(2, item);
  result.items[0].recoveries.resize(3);
  result.items[1].recoveries.resize(1);
  EXPECT_EQ(recovery_count(result), 4);
}

}  // namespace
}  // namespace snug::session
