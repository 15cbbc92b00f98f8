// make_room: a packed box moves where an item then has a place, and stays where that gains nothing.
#include "snug/planning/room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "snug/planning/test/believed.hpp"

namespace snug::planning {
namespace {

const model::ItemIndex kPacked(0), kWithoutPlace(1);
const Budget kShort{0.05, 1};

void set_container(BeliefSnapshot& belief, const Vector3& inner_size) {
  const auto narrow = [&](model::Scenario& scenario) {
    const auto target = std::ranges::find(scenario.containers, scenario.target, &model::Container::name);
    target->inner_size = inner_size;
  };
  narrow(belief.scenario);
  for (World& world : belief.worlds) narrow(world.scenario);
}

void stand_in_container(BeliefSnapshot& belief, const Pose& X_TP) {
  const Pose X_WP = model::find_container(belief.scenario, belief.scenario.target)->X_WT * X_TP;
  belief.boxes[kPacked.slot()] = BelievedBox{X_WP, Matrix6::Identity() * 1e-6, true};
  for (World& world : belief.worlds) world.X_WP[kPacked.slot()] = X_WP;
}

/// Two boxes of 170 x 235 x 94 mm fit flat, one behind the other with 20 mm to spare. The first stands in the middle.
BeliefSnapshot one_in_the_middle() {
  BeliefSnapshot belief = test::first_belief(2);
  belief.agent.name = packing::name_of(packing::AgentKind::ContactAware);
  set_container(belief, Vector3(0.185, 0.490, 0.120));
  stand_in_container(belief, {Matrix3::Identity(), Vector3(0.0, 0.0, 0.047)});
  belief.sent.emplace_back(kPacked);
  return belief;
}

std::optional<Room> make_room(const BeliefSnapshot& belief) {
  PlanningWorkspace work;
  return planning::make_room(belief, kWithoutPlace, kShort, work);
}

TEST(Room, ABoxInTheMiddleMovesAside) {
  const BeliefSnapshot belief = one_in_the_middle();
  ASSERT_EQ(plan(belief, kWithoutPlace, kShort).outcome, PlanOutcome::NoPlace);
  const std::optional<Room> room = make_room(belief);
  ASSERT_TRUE(room);
  EXPECT_EQ(room->plan.item, kPacked);
  EXPECT_EQ(room->plan.flips, 0);
  ASSERT_TRUE(room->plan.best);
  EXPECT_NEAR(std::abs(room->plan.best->planned.X_TP.p.y()), 0.128, 0.005) << "at a wall";
  EXPECT_EQ(hash(plan(room->asked, kPacked, kShort)), hash(room->plan)) << "what is asked is what was planned";
  EXPECT_EQ(hash(make_room(belief)->plan), hash(room->plan));
}

/// The first stands flat, and nothing fits beside it or on it, until it is turned onto its edge.
BeliefSnapshot one_that_lies_flat() {
  BeliefSnapshot belief = one_in_the_middle();
  set_container(belief, Vector3(0.245, 0.210, 0.180));
  stand_in_container(belief, {exp_rotation(Vector3(0.0, 0.0, 0.5 * std::numbers::pi)), Vector3(0.0, 0.0, 0.047)});
  belief.skips_left = 0;
  return belief;
}

TEST(Room, ABoxIsTurnedOverWhereTheSessionEndsOtherwise) {
  BeliefSnapshot belief = one_that_lies_flat();
  ASSERT_EQ(plan(belief, kWithoutPlace, kShort).outcome, PlanOutcome::NoPlace);
  const std::optional<Room> room = make_room(belief);
  ASSERT_TRUE(room);
  EXPECT_FALSE(room->aside);
  EXPECT_EQ(room->plan.item, kPacked);
  EXPECT_GT(room->plan.flips, 0);
  belief.skips_left = 1;
  EXPECT_FALSE(make_room(belief)) << "the next item may have a place";
}

/// The first may carry nothing, and the floor has room for one box.
TEST(Room, ABoxThatHasToStandOnTheItemWaitsUntilThen) {
  BeliefSnapshot belief = one_in_the_middle();
  set_container(belief, Vector3(0.177, 0.250, 0.200));
  belief.scenario.packing.last_interference = belief.scenario.packing.planned_interference;
  stand_in_container(belief, {Matrix3::Identity(), Vector3(0.0, 0.0, 0.047)});
  belief.items[kPacked.slot()].no_stack = true;
  belief.skips_left = 0;
  ASSERT_EQ(plan(belief, kWithoutPlace, kShort).outcome, PlanOutcome::NoPlace);
  const std::optional<Room> room = make_room(belief);
  ASSERT_TRUE(room);
  ASSERT_TRUE(room->aside);
  EXPECT_EQ(room->aside->box, kPacked);
  EXPECT_NEAR(room->aside->item.X_TP.p.z(), 0.047, 0.002) << "on the floor";
  PlanningWorkspace work;
  const Scene scene{room->asked, work.cell_of(room->asked)};
  EXPECT_EQ(scene.locate(kPacked), Location::Bench);
  belief.skips_left = 1;
  EXPECT_FALSE(make_room(belief));
}

TEST(Room, NothingMovesWhereItGainsTooLittle) {
  BeliefSnapshot belief = one_in_the_middle();
  belief.scenario.recovery.gain_elsewhere = 60.0;  // percent: both boxes together fill 69 %
  EXPECT_FALSE(make_room(belief));
}

TEST(Room, NothingMovesForAnAgentThatDoesNotLookAhead) {
  BeliefSnapshot belief = one_in_the_middle();
  belief.agent.name = packing::name_of(packing::AgentKind::Margin);
  EXPECT_FALSE(make_room(belief));
}

TEST(Room, ABoxUnderAnObstacleStays) {
  BeliefSnapshot belief = one_in_the_middle();
  const Vector3 top = belief.boxes[0]->X_WP.p + Vector3(0.0, 0.0, 0.047);
  belief.obstacles = {{top - Vector3(0.04, 0.04, 0.0), top + Vector3(0.04, 0.04, 0.03)}};
  EXPECT_FALSE(make_room(belief));
}

TEST(Room, ABoxThatLeansStays) {
  BeliefSnapshot belief = one_in_the_middle();
  belief.boxes[0]->X_WP.R = Eigen::AngleAxisd(0.5, Vector3::UnitX()).toRotationMatrix() * belief.boxes[0]->X_WP.R;
  EXPECT_FALSE(make_room(belief));
}

}  // namespace
}  // namespace snug::planning
