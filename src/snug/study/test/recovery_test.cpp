// Recovery: faults injected into the plant, each with what the session does about it; no box is left in the way.
#include <gtest/gtest.h>

#include <algorithm>

#include "snug/model/test/shortened.hpp"
#include "snug/study/trial.hpp"

namespace snug::study {
namespace {

using session::Remedy;
using session::Trouble;

Trial run_with(const char* faults, std::size_t items = 3) {
  const model::Scenario scenario = model::test::shortened(items);
  session::SessionOptions options;
  options.decision.time = 0.05;
  options.samples = 2;
  simulated_plant::SimulatedPlantOptions plant;
  plant.seed = 101;
  plant.faults = simulated_plant::parse_faults(faults);
  return run_trial(scenario, "1", options, plant);
}

/// The recoveries of an item, from 1.
const std::vector<session::Recovery>& recoveries_of(const Trial& trial, std::size_t item) {
  return trial.session.items.at(item - 1).recoveries;
}

bool has(const std::vector<session::Recovery>& recoveries, Trouble trouble, Remedy remedy) {
  return std::ranges::any_of(
      recoveries, [&](const session::Recovery& one) { return one.trouble == trouble && one.remedy == remedy; });
}

void expect_nothing_in_the_way(const Trial& trial) {
  EXPECT_FALSE(trial.session.failure) << trial.session.failure.text;
  for (const cell::BoxResult& box : trial.boxes) {
    EXPECT_TRUE(box.state == cell::BoxState::Packed || box.state == cell::BoxState::Waiting)
        << box.id << " is " << cell::name_of(box.state);
  }
}

TEST(Recovery, ABoxThatDoesNotSealIsPickedAgain) {
  const Trial trial = run_with("noseal@2");
  EXPECT_TRUE(has(recoveries_of(trial, 2), Trouble::NoSeal, Remedy::PickAgain));
  EXPECT_EQ(trial.executed_boxes, 3) << trial.session.stopped;
  expect_nothing_in_the_way(trial);
}

TEST(Recovery, AStopIsAcknowledgedAndTheMotionGoesOn) {
  const Trial trial = run_with("stop@2");
  EXPECT_TRUE(has(recoveries_of(trial, 2), Trouble::ProtectiveStop, Remedy::Resume));
  EXPECT_EQ(trial.executed_boxes, 3) << trial.session.stopped;
  expect_nothing_in_the_way(trial);
}

TEST(Recovery, ABoxThatFallsWhileCarriedIsNoticedAndTheSessionGoesOn) {
  const Trial trial = run_with("drop@2");
  const auto& recoveries = recoveries_of(trial, 2);
  EXPECT_TRUE(std::ranges::any_of(recoveries, [](const auto& one) { return one.trouble == Trouble::VacuumLost; }));
  EXPECT_GE(trial.executed_boxes, 2) << trial.session.stopped;
  EXPECT_FALSE(trial.session.failure) << trial.session.failure.text;
}

TEST(Recovery, ADisplacedBoxIsSeenAndLeavesNothingInTheWay) {
  const Trial trial = run_with("displace@2");
  EXPECT_FALSE(recoveries_of(trial, 2).empty());
  EXPECT_EQ(trial.executed_boxes, 3) << trial.session.stopped;
  expect_nothing_in_the_way(trial);
}

TEST(Recovery, APushedNeighbourIsSeenAndLeavesNothingInTheWay) {
  const Trial trial = run_with("push@2");
  EXPECT_FALSE(recoveries_of(trial, 2).empty());
  EXPECT_EQ(trial.executed_boxes, 3) << trial.session.stopped;
  expect_nothing_in_the_way(trial);
}

/// Seen, with its height, planned around, and forgotten when it is taken out: by whoever looks.
TEST(Recovery, AForeignObjectIsPlannedAroundUntilItIsGone) {
  const Trial trial = run_with("object@1,clear@3", 4);
  ASSERT_EQ(trial.objects.size(), 1U);
  const simulated_plant::ForeignObject& truth = trial.objects[0];
  EXPECT_FALSE(truth.is_in);
  EXPECT_LT((truth.X_TB.p - truth.X_TB_put.p).norm(), 0.002) << "nothing pushed it";
  ASSERT_EQ(trial.session.obstacles.size(), 1U);
  const session::ObstacleReport& seen = trial.session.obstacles[0];
  EXPECT_NEAR(seen.high_T.z(), truth.X_TB.p.z() + 0.5 * simulated_plant::kForeignSize.z(), 0.003);
  ASSERT_TRUE(seen.gone);
  EXPECT_GT(*seen.gone, seen.seen);
  EXPECT_EQ(trial.executed_boxes, 4) << trial.session.stopped;
  // In this cell the last one slides 20 mm from its place, where 20 are a trouble, and is accepted there: the object is
  // gone by then, and nothing else moves.
  ASSERT_EQ(trial.items.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(trial.items[i].is_as_planned) << trial.items[i].id;
  EXPECT_LT(trial.items[3].position_error, 0.025);
  EXPECT_LT(trial.items[3].displacement, 0.001);
  const std::vector<record::Event> events = events_of(trial.session);
  EXPECT_EQ(std::ranges::count(events, "obstacle", &record::Event::kind), 2);
}

TEST(Recovery, AllOfThemInOneSession) {
  const Trial trial = run_with("drop@1,noseal@2,displace@3,stop@4", 5);
  EXPECT_GE(trial.recoveries, 4);
  EXPECT_GE(trial.executed_boxes, 4) << trial.session.stopped;
  const std::vector<record::Event> events = events_of(trial.session);
  const auto recoveries = std::ranges::count(events, "recovery", &record::Event::kind);
  EXPECT_EQ(recoveries, trial.recoveries);
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, &record::Event::time));
}

TEST(SessionRecord, EveryAttemptForAnItemWithoutPlaceHasItsReason) {
  model::Scenario scenario = model::test::shortened(1);
  session::SessionOptions options;
  options.decision.time = 0.05;
  options.samples = 0;
  scenario.place_limits.force = 10.0;  // N: less than any pick takes
  const Trial trial = run_trial(scenario, "1", options, {});
  ASSERT_EQ(trial.session.items.size(), 1U);
  const session::ItemReport& item = trial.session.items[0];
  EXPECT_EQ(item.end, session::ItemEnd::NoPlace) << item.reason;
  EXPECT_GT(item.attempts, 0);
  EXPECT_EQ(static_cast<int>(item.failed_attempts.size()), item.attempts);
  for (const planning::Tried& one : item.failed_attempts) {
    EXPECT_FALSE(one.succeeded);
    EXPECT_NE(one.failure, planning::AttemptFailure::None);
    EXPECT_FALSE(one.reason.empty());
    EXPECT_EQ(one.planned.item, item.id);
  }
}

TEST(SessionRecord, SaysWhatWasRefusedAndWhatWasLostWithReasons) {
  session::SessionResult result;
  session::ItemReport refused, lost, packed;
  refused.id = "A";
  refused.end = session::ItemEnd::NoPlace;
  refused.reason = "no space left";
  refused.done = 4.0;
  lost.id = "B";
  lost.end = session::ItemEnd::Left;
  lost.reason = "leaning";
  lost.sends.resize(1);
  packed.id = "C";
  packed.end = session::ItemEnd::Placed;
  packed.sends.resize(1);
  result.items = {packed, lost, refused};
  result.failure = {session::SessionFailureKind::NotHome, "the robot did not come home"};

  const std::vector<record::Event> events = events_of(result);
  const auto event = std::ranges::find(events, "refused", &record::Event::kind);
  ASSERT_NE(event, events.end());
  EXPECT_EQ(event->body, "A");
  EXPECT_EQ(event->time, 4.0);
  EXPECT_EQ(event->text, "no place: no space left");
  EXPECT_EQ(warnings_of(result), (std::vector<std::string>{"the robot did not come home", "B left: leaning"}));
}

}  // namespace
}  // namespace snug::study
