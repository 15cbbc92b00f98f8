// SessionResult: what became of every item, and why a session ended; made of its events (fold.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/planning/plan.hpp"
#include "snug/plant/plant.hpp"
#include "snug/session/item_seconds.hpp"
#include "snug/session/obstacles.hpp"
#include "snug/session/recovery.hpp"

namespace snug::session {

/// What became of an item, as far as the session knows.
enum class ItemEnd {
  Placed,      ///< where it was planned, within the limits
  Accepted,    ///< in the container, but not where it was planned
  NoPlace,     ///< nothing was found that would come to rest as planned; it was taken away
  Infeasible,  ///< it would not fit into the empty container either, is too heavy or cannot be held
  NotHeld,     ///< every pick failed; it was left behind
  Returned,    ///< after tries that failed it was put back to the aligner, and taken away from there
  Left,        ///< it lies where it cannot be picked, or the tries were used up
  Gone,        ///< it is not seen any more
  WrongItem,   ///< another one came in its place; it was taken away
  NotBrought,  ///< the plant did not bring it
  Rejected,    ///< it lies in the container, but not as a box of a finished load has to
  Skipped,     ///< the operator did not want it packed
  TakenOut,  ///< it was packed, and was taken out: the operator asked, or the finished load is accepted only without it
};
[[nodiscard]] const char* name_of(ItemEnd end);

/// One motion for an item that was sent.
struct Send {
  double time = 0.0;               ///< s, of the plant, when it began
  double predicted_success = 0.0;  ///< 0 .. 1
  packing::Placement planned;
  plant::End end;
  Trouble trouble = Trouble::None;  ///< found when it had ended
};

/// What who operates said of an item.
struct OperatorStep {
  double time = 0.0;         ///< s, of the plant
  std::string order;         ///< as a line of `snug pack --operator`, with the item that it was done at
  bool was_followed = true;  ///< false: it could not be, `text` says why
  std::string text;          ///< for people; may be empty
  bool operator==(const OperatorStep&) const = default;
};

/// "BOX027 skip", with why it was not followed.
[[nodiscard]] std::string describe(const OperatorStep& step);

/// Why a session did not end as it should, whatever was packed.
enum class SessionFailureKind {
  None,
  NotHome,    ///< the robot did not come to its start in the end
  PlantLost,  ///< a plant elsewhere ended otherwise than agreed
};
[[nodiscard]] const char* name_of(SessionFailureKind kind);

struct SessionFailure {
  SessionFailureKind kind = SessionFailureKind::None;
  std::string text;  ///< for people
  [[nodiscard]] explicit operator bool() const { return kind != SessionFailureKind::None; }
};

struct ItemReport {
  std::string id;
  ItemEnd end = ItemEnd::NoPlace;
  std::string reason;  ///< for people, where it is not placed
  packing::Placement planned;
  std::optional<Pose> X_TP;  ///< where it was seen (or is believed to be) in the end
  skills::Reorientation reorientation = skills::Reorientation::None;
  skills::InsertionSkill skill = skills::InsertionSkill::TopDown;
  int flips = 0;
  int attempts = 0;                              ///< that were rehearsed for this item
  std::vector<planning::Tried> failed_attempts;  ///< of these, in their order
  int stops = 0;                      ///< of them that ended with a protective stop of the robot, in the nominal world
  int samples = 0;                    ///< in which the one that was sent was rehearsed beside the nominal world
  double success_rate = 0.0;          ///< of these, by weight; means nothing without samples
  double predicted_success = 0.0;     ///< what the session expects of the motion that was sent
  planning::AttemptForces predicted;  ///< largest of the samples; means nothing without samples
  planning::AttemptForces measured;   ///< force and torque on the tool; displacement as it was seen
  double position_error = 0.0;        ///< m, level, as it was seen
  double angle_error = 0.0;           ///< rad
  std::vector<Send> sends;
  std::vector<packing::Placement> made_room;  ///< of boxes that were packed before: moved there, so that this one fits
  std::vector<Recovery> recoveries;
  std::vector<OperatorStep> operator_steps;
  double decision_seconds = 0.0;  ///< wall clock, of the agent alone
  double rehearsal_seconds = 0.0;
  double planning_wait = 0.0;      ///< of both, while the robot stood: the rest passed while it left the item before
  double begin = 0.0, done = 0.0;  ///< s, of the plant
  ItemSeconds seconds;             ///< of all its motions, recoveries included: done - begin
  [[nodiscard]] bool is_packed() const { return end == ItemEnd::Placed || end == ItemEnd::Accepted; }
};

/// How it ended and why: "no place: no space left".
[[nodiscard]] std::string describe(const ItemReport& item);
/// "BOX016 moved to (-44, -186, 100) mm to make room", of an item that another box made room for.
[[nodiscard]] std::string describe_room(const ItemReport& item);

enum class StopReason {
  AllPacked,
  NoMoreItems,  ///< some are not packed
  NoItems,
  NoPlace,      ///< for more items than may be skipped
  RobotStops,   ///< protective stops did not end
  ViewBlocked,  ///< something stays between camera and container
  NoFrame,      ///< the camera gives no frame that can be used
  PlantFault,
  Interrupted,  ///< by who started it
};
[[nodiscard]] const char* name_of(StopReason reason);

struct SessionResult {
  std::string sequence;
  std::string agent;
  std::string plant;  ///< its name
  std::vector<ItemReport> items;
  motion::Program program;               ///< every waypoint that was sent
  std::vector<packing::Placement> plan;  ///< of the items that are packed, in the order of packing
  double planned_percent = 0.0;          ///< of those
  double decision_seconds_median = 0.0;
  double duration = 0.0;  ///< s, of the plant
  StopReason stop_reason = StopReason::NoItems;
  std::string stopped;  ///< the same for people
  SessionFailure failure;
  std::vector<ObstacleReport> obstacles;       ///< that were seen, those that are gone again too
  std::optional<double> percent_before_skips;  ///< planned_percent when the first item without a place was skipped
};
/// "BOX023 leans by 26.5 degrees (6.0 are allowed)", of each item that the check of the finished load rejected.
[[nodiscard]] std::vector<std::string> rejected_items(const SessionResult& result);
[[nodiscard]] int recovery_count(const SessionResult& result);

}  // namespace snug::session
