// Sessions: what a caller is told while they go on and in the end, and what success they predict.
#include "snug/session/session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

TEST(Session, TellsOfEveryItemWhenItIsDone) {
  ScriptedPlant plant;
  std::vector<int> numbers;
  std::vector<std::size_t> plans;
  double last = 0.0;
  const SessionResult result =
      session::pack(two_boxes(), "1", quick_options(), plant, [&](const SessionResult& so_far, int item, int items) {
        numbers.push_back(item);
        plans.push_back(so_far.plan.size());
        EXPECT_EQ(items, 2);
        EXPECT_EQ(so_far.items.size(), static_cast<std::size_t>(item));
        EXPECT_GT(so_far.planned_percent, last);
        EXPECT_GE(so_far.duration, so_far.items.back().done);
        last = so_far.planned_percent;
      });
  EXPECT_EQ(numbers, (std::vector<int>{1, 2}));
  EXPECT_EQ(plans, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(result.stop_reason, StopReason::AllPacked);
  EXPECT_EQ(result.sequence, "1");
  EXPECT_EQ(result.agent, "margin");
  EXPECT_EQ(result.plant, "scripted");
  EXPECT_EQ(result.planned_percent, last);
  EXPECT_FALSE(result.failure);
  EXPECT_EQ(plant.home_count, 1);
  EXPECT_TRUE(result.program.waypoints.back().motion_class == motion::MotionClass::Home);
}

TEST(Session, BringsItemsInTheOrderOfTheSequence) {
  ScriptedPlant plant;
  (void)session::pack(two_boxes(), "1", quick_options(), plant);
  EXPECT_EQ(plant.brought, (std::vector<std::string>{"BOX027", "BOX028"}));
}

TEST(Session, WithoutItemsNothingMoves) {
  ScriptedPlant plant;
  model::Scenario scenario = two_boxes();
  scenario.sequences.front().items.clear();
  const SessionResult result = session::pack(scenario, "1", quick_options(), plant);
  EXPECT_EQ(result.stop_reason, StopReason::NoItems);
  EXPECT_TRUE(plant.motions.empty());
  EXPECT_EQ(result.planned_percent, 0.0);
  EXPECT_EQ(result.decision_seconds_median, 0.0);
}

TEST(Session, WhoIsInterruptedBeforeItBeganBringsNothing) {
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  options.is_interrupted = [] { return true; };
  const SessionResult result = session::pack(two_boxes(), "1", options, plant);
  EXPECT_EQ(result.stop_reason, StopReason::Interrupted);
  EXPECT_TRUE(plant.brought.empty());
  EXPECT_TRUE(plant.motions.empty());
}

TEST(Session, RefusesWhatItDoesNotKnow) {
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  EXPECT_THROW((void)session::pack(two_boxes(), "nine", options, plant), InputError);
  options.agent = "nobody";
  EXPECT_THROW((void)session::pack(two_boxes(), "1", options, plant), InputError);
  model::Scenario bare = two_boxes();
  bare.aligner.reset();
  EXPECT_THROW((void)session::pack(bare, "1", quick_options(), plant), InputError);
  EXPECT_TRUE(plant.brought.empty());
}

/// Manual and offline agents plan first; their boxes come in the plan's order and go where it says.
TEST(Session, APlanMadeOnPaperIsCarriedOut) {
  for (const char* agent : {"manual", "offline"}) {
    SCOPED_TRACE(agent);
    ScriptedPlant plant;
    SessionOptions options = quick_options();
    options.agent = agent;
    options.decision.time = 0.05;
    const SessionResult result = session::pack(two_boxes(), "1", options, plant);
    ASSERT_EQ(result.items.size(), 2U);
    ASSERT_EQ(plant.brought.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(result.items[i].id, plant.brought[i]);
      EXPECT_EQ(result.items[i].end, ItemEnd::Placed) << result.items[i].reason;
      EXPECT_EQ(result.plan[i].item, plant.brought[i]);
    }
  }
}

TEST(Session, ABoxOfAPlanOnPaperThatDoesNotComeIsLeftOut) {
  ScriptedPlant plant;
  plant.not_brought = {"BOX028"};
  SessionOptions options = quick_options();
  options.agent = "manual";
  const SessionResult result = session::pack(two_boxes(), "1", options, plant);
  EXPECT_EQ(result.plan.size(), 1U);
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
}

/// (rate n + prior count) / (n + count): from 97 % without samples toward the rate of many.
TEST(Session, PredictsTheSuccessOfItsRehearsalsAndWhatIsKnownBeforeThem) {
  const settings::RehearsalSettings& rules = two_boxes().rehearsal;
  double last = 0.0;
  for (const int samples : {0, 1, 4}) {
    ScriptedPlant plant;
    SessionOptions options = quick_options();
    options.samples = samples;
    model::Scenario scenario = two_boxes();
    scenario.sequences.front().items.resize(1);
    const ItemReport item = session::pack(scenario, "1", options, plant).items[0];
    EXPECT_EQ(item.samples, samples);
    ASSERT_EQ(item.sends.size(), 1U);
    EXPECT_EQ(item.sends[0].predicted_success, item.predicted_success);
    const double good = samples > 0 ? item.success_rate * samples : 0.0;
    EXPECT_NEAR(item.predicted_success, (good + rules.prior_rate * rules.prior_count) / (samples + rules.prior_count),
                1e-12);
    EXPECT_EQ(item.success_rate, samples > 0 ? 1.0 : item.success_rate) << "an empty floor";
    EXPECT_GT(item.predicted_success, last);
    EXPECT_LT(item.predicted_success, 1.0) << "nothing is sure";
    last = item.predicted_success;
  }
}

TEST(Session, SaysWhatItTriedForAnItemThatHasNoPlace) {
  ScriptedPlant plant;
  model::Scenario scenario = two_boxes();
  scenario.sequences.front().items.resize(1);
  scenario.place_limits.position = 0.0;  // nothing comes to rest where it was planned to the last micrometre
  scenario.rehearsal.max_attempts = scenario.rehearsal.most_attempts = 3;
  const SessionResult result = session::pack(scenario, "1", quick_options(), plant);
  const ItemReport& item = result.items[0];
  EXPECT_EQ(item.end, ItemEnd::NoPlace);
  EXPECT_TRUE(item.sends.empty());
  EXPECT_GE(item.attempts, 3);
  ASSERT_EQ(item.failed_attempts.size(), static_cast<std::size_t>(item.attempts));
  for (const planning::Tried& one : item.failed_attempts) {
    EXPECT_EQ(one.failure, planning::AttemptFailure::OffPlace);
    EXPECT_FALSE(one.succeeded);
    EXPECT_FALSE(one.reason.empty());
    EXPECT_EQ(one.planned.item, "BOX027");
  }
  EXPECT_EQ(item.reason, item.failed_attempts[0].reason);
  EXPECT_TRUE(plant.motions.empty()) << "what fails in a rehearsal is not sent";
}

TEST(Session, MotionsAreGuardedByTheLimitsOfTheScenario) {
  ScriptedPlant fast, slow;
  SessionOptions options = quick_options();
  options.simulation.tracking = motion::FastTracking{};
  (void)session::pack(two_boxes(), "1", options, fast);
  options.simulation.tracking = motion::LaggedTracking{};
  (void)session::pack(two_boxes(), "1", options, slow);
  const settings::PlaceLimits& limits = two_boxes().place_limits;
  EXPECT_EQ(fast.motions[0].guards, (plant::Guards{limits.force, true, limits.hold_guard}));
  EXPECT_EQ(slow.motions[0].guards, (plant::Guards{limits.force, true, 0.0})) << "of fast motions only";
  EXPECT_EQ(fast.motions.back().guards, (plant::Guards{std::nullopt, false, 0.0})) << "home";
}

TEST(Session, TheFillingIsThatOfTheSizesInTheScenario) {
  ScriptedPlant plant;
  const SessionResult result = session::pack(two_boxes(), "1", quick_options(), plant);
  double volume = 0.0;
  for (const char* id : {"BOX027", "BOX028"}) volume += model::find_parcel(two_boxes(), id)->size.prod();
  const model::Container& container = *model::find_container(two_boxes(), two_boxes().target);
  EXPECT_NEAR(result.planned_percent, 100.0 * volume / container.inner_size.prod(), 1e-9);
}

}  // namespace
}  // namespace snug::session
