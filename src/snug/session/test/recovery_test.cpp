// Recovery: the table of troubles and remedies.
#include "snug/session/recovery.hpp"

#include <gtest/gtest.h>

namespace snug::session {
namespace {

const settings::RecoverySettings kSettings;

Remedy remedy_for(const Situation& situation) { return choose_remedy(situation, kSettings); }

Situation at(Trouble trouble) {
  Situation situation;
  situation.trouble = trouble;
  situation.tries = 1;
  situation.can_be_picked = true;
  return situation;
}

TEST(ChooseRemedy, NothingIsDoneAboutNothing) { EXPECT_EQ(remedy_for(at(Trouble::None)), Remedy::None); }

TEST(ChooseRemedy, WhatDidNotSealOrFellIsPickedAgainWhereItLiesUntilTheTriesAreUsedUp) {
  for (const Trouble trouble : {Trouble::NoSeal, Trouble::VacuumLost, Trouble::OffPlace}) {
    Situation situation = at(trouble);
    for (situation.tries = 1; situation.tries < kSettings.most_tries; ++situation.tries) {
      EXPECT_EQ(remedy_for(situation), Remedy::PickAgain) << name_of(trouble) << " " << situation.tries;
    }
    EXPECT_EQ(remedy_for(situation), Remedy::Skip);
    situation.tries = 1;
    situation.can_be_picked = false;
    EXPECT_EQ(remedy_for(situation), Remedy::Skip);
    situation.fits = true;  // it fell into the container, and may stay
    EXPECT_EQ(remedy_for(situation), Remedy::Accept);
  }
}

TEST(ChooseRemedy, ABoxThatFellOverInTheContainerIsPickedAgainWhereItCanBe) {
  Situation situation = at(Trouble::VacuumLost);
  situation.fits = true;
  EXPECT_EQ(remedy_for(situation), Remedy::Accept) << "as it was meant to lie";
  situation.lies_turned = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PickAgain);
  situation.tries = kSettings.most_tries;
  EXPECT_EQ(remedy_for(situation), Remedy::Accept) << "enough was tried";
  situation.tries = 1;
  situation.can_be_picked = false;
  EXPECT_EQ(remedy_for(situation), Remedy::Accept);
}

TEST(ChooseRemedy, ABoxThatWasMovedIsPickedAgainWhereThatIsWorthIt) {
  for (const Trouble trouble : {Trouble::OffPlace, Trouble::NeighbourMoved}) {
    Situation situation = at(trouble);
    situation.fits = true;
    EXPECT_EQ(remedy_for(situation), Remedy::Accept);
    situation.gain_elsewhere = kSettings.gain_elsewhere + 0.1;
    EXPECT_EQ(remedy_for(situation), Remedy::PickAgain);
    situation.tries = kSettings.most_tries;
    EXPECT_EQ(remedy_for(situation), Remedy::Accept) << "enough was tried";
  }
}

TEST(ChooseRemedy, ANeighbourThatLeansIsPressedThenPickedAgainAndAcceptedOnlyWhereNeitherCanBe) {
  Situation situation = at(Trouble::NeighbourMoved);
  situation.fits = situation.leans = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PressLevel);
  situation.was_pressed = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PickAgain);
  situation.can_be_picked = false;
  EXPECT_EQ(remedy_for(situation), Remedy::Accept);
  situation.can_return = true;
  EXPECT_EQ(remedy_for(situation), Remedy::ReturnToAligner);
  situation.lies_on_others = situation.can_be_picked = true;
  situation.was_pressed = false;
  EXPECT_EQ(remedy_for(situation), Remedy::PickAgain) << "pressed on, it would push the others away";
}

TEST(ChooseRemedy, ANeighbourThatLiesOnOthersIsTakenOffAndPressedOnlyWhereItCannotBe) {
  Situation situation = at(Trouble::SticksOut);
  situation.lies_on_others = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PickAgain);
  situation.can_be_picked = false;
  EXPECT_EQ(remedy_for(situation), Remedy::PressLevel);
  situation.can_be_picked = true;
  situation.tries = kSettings.most_tries;
  EXPECT_EQ(remedy_for(situation), Remedy::PressLevel);
}

TEST(ChooseRemedy, AStopIsResumedOnceThenTheBoxIsLetGoAndAtLastTheSessionEnds) {
  Situation situation = at(Trouble::ProtectiveStop);
  situation.is_held = true;
  situation.stops = 1;
  EXPECT_EQ(remedy_for(situation), Remedy::Resume);
  situation.stops = 2;
  EXPECT_EQ(remedy_for(situation), Remedy::Release);
  situation.stops = 4;
  EXPECT_EQ(remedy_for(situation), Remedy::Stop);
  situation.stops = 1;
  situation.is_held = false;
  EXPECT_EQ(remedy_for(situation), Remedy::Release);
}

TEST(ChooseRemedy, WhatLeansOrSticksOutIsPressedOnceAndThenTakenOut) {
  for (const Trouble trouble : {Trouble::Leaning, Trouble::SticksOut}) {
    Situation situation = at(trouble);
    EXPECT_EQ(remedy_for(situation), Remedy::PressLevel);
    situation.was_pressed = true;
    EXPECT_EQ(remedy_for(situation), Remedy::PickAgain);
    situation.can_be_picked = false;
    EXPECT_EQ(remedy_for(situation), Remedy::Skip);
  }
}

TEST(ChooseRemedy, ABoxThatMeetsTooMuchForceIsPutDownOnTheBenchWhereThereIsOne) {
  for (const Trouble trouble : {Trouble::ForceGuard, Trouble::Timeout}) {
    Situation situation = at(trouble);
    EXPECT_EQ(remedy_for(situation), Remedy::Release) << "nothing is held";
    situation.is_held = true;
    EXPECT_EQ(remedy_for(situation), Remedy::Release) << "no bench";
    situation.can_set_down = true;
    EXPECT_EQ(remedy_for(situation), Remedy::SetDown);
    situation.tries = kSettings.most_tries;
    EXPECT_EQ(remedy_for(situation), Remedy::Release) << "it was returned in vain";
    situation.can_return = true;
    EXPECT_EQ(remedy_for(situation), Remedy::ReturnToAligner);
  }
}

TEST(ChooseRemedy, WhatCannotStayIsPressedWhereItLeansAndElseReturnedWhereItCanBe) {
  Situation situation = at(Trouble::VacuumLost);
  situation.tries = kSettings.most_tries;
  situation.can_return = situation.leans = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PressLevel);
  situation.was_pressed = true;
  EXPECT_EQ(remedy_for(situation), Remedy::ReturnToAligner);
  situation.can_return = false;
  EXPECT_EQ(remedy_for(situation), Remedy::Skip);
  situation.fits = true;
  EXPECT_EQ(remedy_for(situation), Remedy::Accept);
}

TEST(ChooseRemedy, PicturesAreTakenThreeTimesThenBeliefGoesOnAndABlockedViewEndsTheSession) {
  Situation situation = at(Trouble::BadPicture);
  for (situation.pictures = 1; situation.pictures < 3; ++situation.pictures) {
    EXPECT_EQ(remedy_for(situation), Remedy::PerceiveAgain);
  }
  EXPECT_EQ(remedy_for(situation), Remedy::Believe);
  situation = at(Trouble::ViewBlocked);
  situation.pictures = 1;
  EXPECT_EQ(remedy_for(situation), Remedy::MoveAway);
  situation.is_held = true;
  EXPECT_EQ(remedy_for(situation), Remedy::PerceiveAgain) << "not with a box";
  situation.pictures = 3;
  EXPECT_EQ(remedy_for(situation), Remedy::Stop);
}

TEST(ChooseRemedy, EveryTroubleHasARemedyAndAName) {
  for (int i = 1; i <= static_cast<int>(Trouble::PlantFault); ++i) {
    const Trouble trouble = static_cast<Trouble>(i);
    EXPECT_NE(remedy_for(at(trouble)), Remedy::None) << name_of(trouble);
    EXPECT_STRNE(name_of(trouble), "");
    EXPECT_STRNE(name_of(remedy_for(at(trouble))), "");
  }
}

}  // namespace
}  // namespace snug::session
