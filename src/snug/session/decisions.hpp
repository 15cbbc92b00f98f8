// Decisions: plans of a session, now or ahead in a thread of their own, each on a copy of what is believed.
#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "snug/planning/plan.hpp"
#include "snug/planning/room.hpp"
#include "snug/plant/plant.hpp"

namespace snug::session {

struct Decided {
  planning::Plan plan;
  double waited = 0.0;      ///< s of wall clock that the robot stood for it
  std::string belief_file;  ///< where the belief was saved; empty: it was not
  std::string hash;         ///< planning::hash of the plan, where the belief was saved: `snug plan` comes to the same
  std::optional<planning::Room> room = {};  ///< for an item without a place
  double room_seconds = 0.0;                ///< wall clock of the search for it
};

/// The next item, that was brought while the tool left the one before.
struct AheadItem {
  model::ItemIndex item;
  bool is_seen = false;            ///< where it stands: it need not be perceived again
  std::optional<Decided> decided;  ///< none: it is planned when it is its turn
};

class Decisions {
 public:
  /// `save_to`: folder for a file of every belief that is decided on.
  Decisions(planning::Budget budget, packing::Ask ask, std::optional<std::filesystem::path> save_to);

  /// Throws InputError for an agent that is not known.
  void prepare(const planning::BeliefSnapshot& belief);
  /// `may_make_room`: where the item has no place another box may move.
  [[nodiscard]] Decided decide(const planning::BeliefSnapshot& belief, model::ItemIndex item, bool may_make_room);
  /// At this place, and nowhere else.
  [[nodiscard]] Decided decide_at(planning::BeliefSnapshot belief, model::ItemIndex item,
                                  const packing::Placement& place);
  /// The move as a decision of its own.
  [[nodiscard]] Decided decided_move(planning::Room room);
  [[nodiscard]] double gain_elsewhere(const planning::BeliefSnapshot& belief, model::ItemIndex item);

  /// The item was brought ahead.
  void bring_ahead(model::ItemIndex item) { ahead_ = AheadItem{item, false, std::nullopt}; }
  void see_ahead() { ahead_->is_seen = true; }
  /// It was seen: its planning begins, at `time` s of the plant, for a robot that will stand as the belief says.
  void decide_ahead(planning::BeliefSnapshot belief, double time);
  [[nodiscard]] bool has_ahead() const { return ahead_.has_value(); }
  /// The motion under which it was planned has ended: waits for the plan. It is dropped where the robot does not stand
  /// as it was to, and given back. What planning threw is thrown here.
  [[nodiscard]] std::optional<Decided> end_ahead(const plant::Feedback& robot);
  /// None: this item was not brought ahead. What was brought ahead is forgotten.
  [[nodiscard]] std::optional<AheadItem> take_ahead(model::ItemIndex item);

 private:
  [[nodiscard]] Decided make(const planning::BeliefSnapshot& belief, model::ItemIndex item, std::string file,
                             bool may_make_room);
  [[nodiscard]] std::string save(const planning::BeliefSnapshot& belief, model::ItemIndex item);

  planning::Budget budget_;
  std::optional<std::filesystem::path> save_to_;
  int saved_ = 0;
  planning::PlanningWorkspace work_;  ///< of one thread at a time: nothing is decided here while it plans ahead
  std::optional<AheadItem> ahead_;
  planning::RobotState expected_;  ///< where the plan ahead begins
  double since_ = 0.0;             ///< s, of the plant
  std::future<Decided> deciding_;  ///< last: it is waited for before anything that it uses dies
};

}  // namespace snug::session
