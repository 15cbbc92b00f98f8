// Recovery: what went wrong with an item, and what is done about it: a table, docs/session.md.
#pragma once

#include <string>

#include "snug/settings/session_settings.hpp"

namespace snug::session {

/// What went wrong, as far as the session can tell from the robot's sensors and from an observation.
enum class Trouble {
  None,
  NoSeal,          ///< the cup did not seal
  VacuumLost,      ///< the box fell from the cup
  ForceGuard,      ///< the tool met more force than it may
  HoldGuard,       ///< the cup could hardly have held the box any more
  ProtectiveStop,  ///< the robot stopped itself
  Timeout,         ///< a waypoint was not reached
  OffPlace,        ///< it lies further than the limits from where it was planned
  Leaning,         ///< it leans
  NeighbourMoved,  ///< it lies where it should, but another box was moved beyond the limit
  SticksOut,       ///< it, or another box, stands over the rim or beyond a wall
  Gone,            ///< it is not seen where it could be
  WrongItem,       ///< its edges at the aligner are other ones than those of the item that was to come
  BadPicture,      ///< an observation has too few points to tell anything
  ViewBlocked,     ///< something is between camera and container
  NoFrame,         ///< the camera gives no frame that can be used
  Cancelled,       ///< somebody ended the motion: the session was interrupted
  PlantFault,      ///< the cell itself failed
};
[[nodiscard]] const char* name_of(Trouble trouble);

enum class Remedy {
  None,
  Resume,           ///< acknowledge the stop, and go on with the rest of the motion
  SetDown,          ///< go up with the box, put it down on the bench, perceive, plan anew
  Release,          ///< let go where it is, go up, perceive
  PickAgain,        ///< perceive, plan anew, pick it where it lies
  PressLevel,       ///< press on it from above, perceive
  Accept,           ///< it stays where it lies; what follows is planned around it
  ReturnToAligner,  ///< planned anew from there, or taken away by the next arrival
  Skip,             ///< it is left, or taken away; the next item comes
  PerceiveAgain,    ///< another picture
  MoveAway,         ///< the tool goes to its start, another picture
  Believe,          ///< go on with what is believed
  Stop,             ///< the session ends
};
[[nodiscard]] const char* name_of(Remedy remedy);

/// What the choice depends on.
struct Situation {
  Trouble trouble = Trouble::None;
  int tries = 0;                ///< motions that were sent for this item before, this one included
  int stops = 0;                ///< protective stops of this item, this one included
  bool is_held = false;         ///< the vacuum says that something hangs from the cup
  bool can_set_down = false;    ///< there is a bench to put it on
  bool can_return = false;      ///< held, or pickable elsewhere than at the aligner; tried twice at most for one motion
  bool fits = false;            ///< it lies in the container, inside walls and rim
  bool leans = false;           ///< in the container, by more than the limit
  bool lies_turned = false;     ///< by more than 45 degrees from its plan: it takes room meant for others
  bool lies_on_others = false;  ///< a neighbour that was moved: pressed on, it would push them away
  bool can_be_picked = false;   ///< seen, standing on a face, within reach of the tool
  double gain_elsewhere = 0.0;  ///< percent of the container that is expected more with it in another place
  bool was_pressed = false;     ///< since it was let go
  int pictures = 0;             ///< that told nothing, one after the other, this one included
};
[[nodiscard]] Remedy choose_remedy(const Situation& situation, const settings::RecoverySettings& settings);

/// One that was taken: for the result and the list of events.
struct Recovery {
  double time = 0.0;  ///< s, of the plant
  std::string item;
  Trouble trouble = Trouble::None;
  Remedy remedy = Remedy::None;
  std::string detail;
};

}  // namespace snug::session
