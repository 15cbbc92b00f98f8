// Recovery: what went wrong with an item, and what is done about it: a table, docs/session.md.
#include "snug/session/recovery.hpp"

namespace snug::session {
namespace {

/// One that leans takes room meant for others and carries nothing: it is not accepted while anything can be done.
Remedy level_or_move(const Situation& at, const settings::RecoverySettings& settings) {
  const bool may_move = at.tries < settings.most_tries;
  if (at.lies_on_others && at.can_be_picked && may_move) return Remedy::PickAgain;
  if (!at.was_pressed) return Remedy::PressLevel;
  if (at.can_be_picked && may_move) return Remedy::PickAgain;
  return at.can_return && may_move ? Remedy::ReturnToAligner : Remedy::Accept;
}

Remedy where_it_lies(const Situation& at, const settings::RecoverySettings& settings) {
  const bool may_pick = at.can_be_picked && at.tries < settings.most_tries;
  const bool may_return = at.can_return && at.tries < settings.most_tries;
  const bool is_worth_moving = at.gain_elsewhere > settings.gain_elsewhere;
  if (at.fits && !at.lies_turned && !is_worth_moving) return Remedy::Accept;
  if (at.fits) return may_pick ? Remedy::PickAgain : may_return ? Remedy::ReturnToAligner : Remedy::Accept;
  if (may_pick) return Remedy::PickAgain;
  if (at.leans && !at.was_pressed) return Remedy::PressLevel;
  return at.can_return ? Remedy::ReturnToAligner : Remedy::Skip;
}

}  // namespace

const char* name_of(Trouble trouble) {
  switch (trouble) {
    case Trouble::None:
      return "none";
    case Trouble::NoSeal:
      return "no seal";
    case Trouble::VacuumLost:
      return "vacuum lost";
    case Trouble::ForceGuard:
      return "force guard";
    case Trouble::HoldGuard:
      return "hold guard";
    case Trouble::ProtectiveStop:
      return "protective stop";
    case Trouble::Timeout:
      return "timeout";
    case Trouble::OffPlace:
      return "off its place";
    case Trouble::Leaning:
      return "leaning";
    case Trouble::NeighbourMoved:
      return "neighbour moved";
    case Trouble::SticksOut:
      return "sticks out";
    case Trouble::Gone:
      return "gone";
    case Trouble::WrongItem:
      return "wrong item";
    case Trouble::BadPicture:
      return "bad picture";
    case Trouble::ViewBlocked:
      return "view blocked";
    case Trouble::NoFrame:
      return "no frame";
    case Trouble::Cancelled:
      return "interrupted";
    case Trouble::PlantFault:
      return "plant fault";
  }
  return "";
}

const char* name_of(Remedy remedy) {
  switch (remedy) {
    case Remedy::None:
      return "none";
    case Remedy::Resume:
      return "resume";
    case Remedy::SetDown:
      return "set down";
    case Remedy::Release:
      return "release";
    case Remedy::PickAgain:
      return "pick again";
    case Remedy::PressLevel:
      return "press level";
    case Remedy::Accept:
      return "accept";
    case Remedy::ReturnToAligner:
      return "return to aligner";
    case Remedy::Skip:
      return "skip";
    case Remedy::PerceiveAgain:
      return "perceive again";
    case Remedy::MoveAway:
      return "move away";
    case Remedy::Believe:
      return "believe";
    case Remedy::Stop:
      return "stop";
  }
  return "";
}

Remedy choose_remedy(const Situation& at, const settings::RecoverySettings& settings) {
  switch (at.trouble) {
    case Trouble::None:
      return Remedy::None;
    case Trouble::Cancelled:
    case Trouble::PlantFault:
      return Remedy::Stop;
    case Trouble::ProtectiveStop:
      if (at.stops == 1 && at.is_held) return Remedy::Resume;
      return at.stops <= settings.most_stops ? Remedy::Release : Remedy::Stop;
    case Trouble::ForceGuard:
    case Trouble::HoldGuard:
    case Trouble::Timeout:
      if (at.is_held && at.can_set_down && at.tries < settings.most_tries) return Remedy::SetDown;
      return at.is_held && at.can_return && at.tries >= settings.most_tries ? Remedy::ReturnToAligner : Remedy::Release;
    case Trouble::NoSeal:
    case Trouble::VacuumLost:
    case Trouble::OffPlace:
      return where_it_lies(at, settings);
    case Trouble::Leaning:
    case Trouble::SticksOut:
      if (at.lies_on_others && at.can_be_picked && at.tries < settings.most_tries) return Remedy::PickAgain;
      if (at.was_pressed) return where_it_lies(at, settings);
      return Remedy::PressLevel;
    case Trouble::NeighbourMoved:
      return at.fits && at.leans ? level_or_move(at, settings) : where_it_lies(at, settings);
    case Trouble::Gone:
    case Trouble::WrongItem:
      return Remedy::Skip;
    case Trouble::BadPicture:
      return at.pictures < settings.most_pictures ? Remedy::PerceiveAgain : Remedy::Believe;
    case Trouble::NoFrame:
      return at.pictures < settings.most_pictures ? Remedy::PerceiveAgain : Remedy::Stop;
    case Trouble::ViewBlocked:
      if (at.pictures >= settings.most_pictures) return Remedy::Stop;
      return at.is_held ? Remedy::PerceiveAgain : Remedy::MoveAway;
  }
  return Remedy::Stop;
}

}  // namespace snug::session
