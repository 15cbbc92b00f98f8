// plan: the same belief, the same decision, whatever was planned before, wherever and by how many threads.
#include "snug/planning/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "snug/core/input_error.hpp"
#include "snug/planning/belief_json.hpp"
#include "snug/planning/test/believed.hpp"

namespace snug::planning {
namespace {

const model::ItemIndex kAtAligner(1);
const Budget kQuick{0.05, 1};

BeliefSnapshot believed() { return test::first_belief(2); }

TEST(Plan, FindsAPlaceInAnEmptyContainerAndSaysWhatItTried) {
  const Plan one = plan(believed(), kAtAligner, kQuick);
  ASSERT_EQ(one.outcome, PlanOutcome::Found) << one.reason;
  ASSERT_TRUE(one.best);
  EXPECT_TRUE(one.reason.empty());
  EXPECT_EQ(one.box.id, "BOX028");
  EXPECT_GE(one.attempts, 1);
  ASSERT_FALSE(one.tried.empty());
  EXPECT_EQ(std::ranges::count(one.tried, Verdict::Best, &Tried::verdict), 1);
  const auto best = std::ranges::find(one.tried, Verdict::Best, &Tried::verdict);
  EXPECT_EQ(best->planned, one.best->planned);
  EXPECT_TRUE(best->succeeded);
  for (const Tried& other : one.tried) EXPECT_LE(other.was_rehearsed() ? other.utility : 0.0, best->utility + 1e-9);
}

TEST(Plan, IsTheSameFromAFileInAnotherThreadAndAfterOtherPlans) {
  const BeliefSnapshot belief = believed();
  const std::uint64_t first = hash(plan(belief, kAtAligner, kQuick));
  const PlanRequest saved = parse_request(format_request({belief, kAtAligner, kQuick}), "belief.json");
  EXPECT_EQ(hash(plan(saved.belief, saved.item, saved.budget)), first);
  PlanningWorkspace work;
  BeliefSnapshot other = belief;
  auto& parcels = other.worlds[1].scenario.parcels;
  std::ranges::find(parcels, other.items[1].id, &model::Parcel::id)->size.x() += 0.004;
  EXPECT_NE(hash(plan(other, kAtAligner, kQuick, work)), first) << "one world has a wider box";
  EXPECT_EQ(hash(plan(belief, kAtAligner, kQuick, work)), first) << "what was planned before is forgotten";
  auto ahead = std::async(std::launch::async, [belief] {
    return hash(plan(belief, kAtAligner, {kQuick.decision_time, 2}));
  });
  EXPECT_EQ(ahead.get(), first);
}

TEST(Plan, LeavesTheBeliefAsItIs) {
  const BeliefSnapshot belief = believed();
  const BeliefSnapshot before = belief;
  (void)plan(belief, kAtAligner, kQuick);
  EXPECT_EQ(belief, before);
}

TEST(Plan, GoesWhereAPlaceWasChosenBefore) {
  BeliefSnapshot belief = believed();
  belief.chosen.resize(2);
  const Plan nowhere = plan(belief, kAtAligner, kQuick);
  EXPECT_EQ(nowhere.outcome, PlanOutcome::NoPlace) << "no place was chosen for it";
  EXPECT_FALSE(nowhere.best);
  const Plan free = plan(believed(), kAtAligner, kQuick);
  packing::Placement place = free.best->planned;
  place.X_TP.p.x() += 0.01;
  belief.chosen[1] = place;
  const Plan one = plan(belief, kAtAligner, kQuick);
  ASSERT_EQ(one.outcome, PlanOutcome::Found) << one.reason;
  EXPECT_LT((one.best->planned.X_TP.p - place.X_TP.p).norm(), 1e-3);
}

TEST(Plan, SaysWhyThereIsNoPlace) {
  BeliefSnapshot belief = believed();
  for (World& world : belief.worlds) world.scenario.place_limits.force = 1.0;
  belief.scenario.place_limits.force = 10.0;  // N: less than any pick takes
  const Plan one = plan(belief, kAtAligner, kQuick);
  EXPECT_EQ(one.outcome, PlanOutcome::NoPlace);
  EXPECT_FALSE(one.reason.empty());
  for (const Tried& other : one.tried) {
    if (other.was_rehearsed()) {
      EXPECT_EQ(other.verdict, Verdict::Failed);
      EXPECT_FALSE(other.reason.empty());
    }
  }
}

/// The item at the aligner has this mass in every world, kg.
BeliefSnapshot with_mass(BeliefSnapshot belief, double mass) {
  for (World& world : belief.worlds) {
    auto& parcels = world.scenario.parcels;
    SpatialInertia& inertia = std::ranges::find(parcels, belief.items[1].id, &model::Parcel::id)->inertia;
    inertia.inertia *= mass / inertia.mass;
    inertia.mass = mass;
  }
  belief.items[1].mass = mass;
  return belief;
}

TEST(Plan, PushesABoxThatIsHeavyForItsCupWhileItsSupportCarriesIt) {
  BeliefSnapshot belief = believed();
  belief.agent.name = packing::name_of(packing::AgentKind::ContactAware);  // against walls
  const Plan light = plan(with_mass(belief, 1.0), kAtAligner, kQuick);
  ASSERT_TRUE(light.best) << light.reason;
  EXPECT_EQ(light.best->skill, skills::InsertionSkill::SlideToContact);
  const Plan heavy = plan(with_mass(belief, 6.0), kAtAligner, kQuick);
  ASSERT_TRUE(heavy.best) << heavy.reason;
  EXPECT_EQ(heavy.best->skill, skills::InsertionSkill::SlideOnSupport);
  EXPECT_EQ(heavy.best->success_rate, 1.0);
  for (const Tried& one : heavy.tried) {
    if (one.was_rehearsed()) {
      EXPECT_NE(one.skill, skills::InsertionSkill::SlideToContact);
    }
  }
  const Plan heavier = plan(with_mass(belief, 7.8), kAtAligner, kQuick);
  EXPECT_EQ(heavier.outcome, PlanOutcome::NoPlace)
      << "it hangs with little more than is asked for, and has to be lifted";
  EXPECT_LE(heavier.attempts, 12) << "what the lift shows is not tried again at every place";
}

TEST(Plan, RefusesAnAgentThatIsNotKnownAndOneThatNobodyAsks) {
  BeliefSnapshot belief = believed();
  belief.agent.name = "nobody";
  EXPECT_THROW((void)plan(belief, kAtAligner, kQuick), InputError);
  belief = believed();
  belief.agent.is_asked = true;
  EXPECT_THROW((void)plan(belief, kAtAligner, kQuick), InputError);
}

}  // namespace
}  // namespace snug::planning
