// Decisions: plans of a session, now or ahead in a thread of their own, each on a copy of what is believed.
#include "snug/session/decisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/stopwatch.hpp"
#include "snug/core/write_file.hpp"
#include "snug/planning/belief_json.hpp"

namespace snug::session {
namespace {

constexpr double kSamePosition = 0.001;  ///< m, of the tool: where it was planned from
constexpr double kSameAngle = 0.002;     ///< rad, of the tool and of joints

bool stands_as(const plant::Feedback& robot, const planning::RobotState& expected) {
  if ((robot.X_WE.p - expected.X_WE.p).norm() > kSamePosition) return false;
  if (angle_between(robot.X_WE.R, expected.X_WE.R) > kSameAngle) return false;
  return std::ranges::equal(robot.q, expected.q,
                            [](double is, double was) { return std::abs(is - was) <= kSameAngle; });
}

/// Wall clock.
double seconds_of(const Decided& decided) {
  return decided.plan.decision_seconds + decided.plan.rehearsal_seconds + decided.room_seconds;
}

/// Where the belief was saved.
void add_hash(Decided& decided) {
  if (!decided.belief_file.empty()) decided.hash = fmt::format("{:016x}", planning::hash(decided.plan));
}

}  // namespace

Decisions::Decisions(planning::Budget budget, packing::Ask ask, std::optional<std::filesystem::path> save_to)
    : budget_(budget), save_to_(std::move(save_to)), work_(std::move(ask)) {}

std::string Decisions::save(const planning::BeliefSnapshot& belief, model::ItemIndex item) {
  if (!save_to_) return {};
  const std::string name = fmt::format("{:04}-{}.json", ++saved_, belief.items[item.slot()].id);
  write_file(*save_to_ / name, planning::format_request({belief, item, budget_}));
  return name;
}

void Decisions::prepare(const planning::BeliefSnapshot& belief) {
  if (save_to_) planning::expect_can_be_saved(belief);
  if (belief.chosen.empty()) (void)work_.agent_for(belief, model::ItemIndex(0), budget_);
}

Decided Decisions::make(const planning::BeliefSnapshot& belief, model::ItemIndex item, std::string file,
                        bool may_make_room) {
  Decided decided{planning::plan(belief, item, budget_, work_), 0.0, std::move(file), {}};
  add_hash(decided);
  const bool leaves_places = belief.chosen.empty() && !belief.agent.is_asked;  // to the agent, which decides here
  if (may_make_room && leaves_places && decided.plan.outcome == planning::PlanOutcome::NoPlace) {
    const auto start = std::chrono::steady_clock::now();
    decided.room = planning::make_room(belief, item, budget_, work_);
    decided.room_seconds = seconds_since(start);
  }
  return decided;
}

Decided Decisions::decide(const planning::BeliefSnapshot& belief, model::ItemIndex item, bool may_make_room) {
  SNUG_CHECK(!deciding_.valid(), "one plan at a time");
  std::string file = save(belief, item);
  const auto start = std::chrono::steady_clock::now();
  Decided decided = make(belief, item, std::move(file), may_make_room);
  decided.waited = seconds_since(start);
  return decided;
}

Decided Decisions::decide_at(planning::BeliefSnapshot belief, model::ItemIndex item, const packing::Placement& place) {
  belief.chosen.assign(belief.items.size(), std::nullopt);
  belief.chosen[item.slot()] = place;
  return decide(belief, item, false);
}

Decided Decisions::decided_move(planning::Room room) {
  const model::ItemIndex item = room.plan.item;
  Decided decided{std::move(room.plan), 0.0, save(room.asked, item), {}};
  add_hash(decided);
  return decided;
}

double Decisions::gain_elsewhere(const planning::BeliefSnapshot& belief, model::ItemIndex item) {
  SNUG_CHECK(!deciding_.valid(), "one plan at a time");
  return planning::gain_elsewhere(belief, item, budget_, work_);
}

void Decisions::decide_ahead(planning::BeliefSnapshot belief, double time) {
  const model::ItemIndex item = ahead_->item;
  std::string file = save(belief, item);
  expected_ = belief.robot;
  since_ = time;
  deciding_ = std::async(std::launch::async, [this, item, belief = std::move(belief), file = std::move(file)] {
    return make(belief, item, file, true);
  });
}

std::optional<Decided> Decisions::end_ahead(const plant::Feedback& robot) {
  if (!ahead_) return std::nullopt;
  const bool has_completed = robot.end.reason == plant::EndReason::Completed;
  if (!has_completed) ahead_->is_seen = false;
  if (!deciding_.valid()) return std::nullopt;
  Decided decided = deciding_.get();
  const double planning = seconds_of(decided);
  decided.waited = std::max(0.0, planning - (robot.time - since_));
  if (!has_completed || !stands_as(robot, expected_)) return decided;
  ahead_->decided = std::move(decided);
  return std::nullopt;
}

std::optional<AheadItem> Decisions::take_ahead(model::ItemIndex item) {
  std::optional<AheadItem> ahead = std::exchange(ahead_, std::nullopt);
  if (ahead && ahead->item != item) ahead.reset();
  return ahead;
}

}  // namespace snug::session
