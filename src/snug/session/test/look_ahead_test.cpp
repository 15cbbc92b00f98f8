// Look ahead: the next item is brought, seen and planned while the tool leaves the one before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using plant::EndReason;
using test::has;
using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

SessionResult pack(ScriptedPlant& plant, const SessionOptions& options = quick_options(),
                   const model::Scenario& scenario = two_boxes()) {
  plant.passes = true;
  return session::pack(scenario, "1", options, plant);
}

using Names = std::vector<std::string>;

TEST(LookAhead, BringsThePlannedItemWhileTheToolLeavesTheOneBefore) {
  ScriptedPlant plant;
  const SessionResult result = pack(plant);
  EXPECT_EQ(plant.brought, (Names{"BOX027", "BOX028"}));
  EXPECT_EQ(plant.brought_on_the_way, Names{"BOX028"});
  ASSERT_EQ(result.items.size(), 2U);
  for (const ItemReport& item : result.items) {
    EXPECT_EQ(item.end, ItemEnd::Placed) << item.reason;
    EXPECT_EQ(item.sends.size(), 1U);
    EXPECT_GE(item.attempts, 1);
  }
  ASSERT_EQ(plant.motions.size(), 3U) << "two boxes and the way home";
  EXPECT_EQ(result.items[1].begin, result.items[0].done);
}

TEST(LookAhead, TheToolWaitsWhereTheNextPickBegins) {
  ScriptedPlant plant;
  model::Scenario slower = two_boxes();
  slower.robot->velocity_fraction = 0.5;  // what is decided for the second box does not change while the tool leaves
  (void)pack(plant, quick_options(), slower);
  const auto& first = plant.motions[0].waypoints;
  const auto& second = plant.motions[1].waypoints;
  EXPECT_EQ(first.back().variant, "_away");
  const model::Scenario fixed = cell::with_fixed_arrivals(two_boxes(), "1");
  const Pose arrival = cell::arrival_pose(fixed, fixed.sequences.front().items[1]);
  const Vector3 off = first.back().X_WE.p - arrival.p;
  EXPECT_LT(off.head<2>().norm(), 0.25) << "over the aligner, or at a side of the box";
  EXPECT_GT(off.z(), 0.0);
  EXPECT_EQ(second.front().motion_class, motion::MotionClass::PrePick) << "the box comes then in a run of the program";
  EXPECT_EQ(second.front().X_WE, first.back().X_WE) << "the tool is there already";
  EXPECT_EQ(plant.motions[1].waypoints.back().motion_class, motion::MotionClass::PostPlace);
  EXPECT_NE(plant.motions[1].waypoints.back().variant, "_away") << "nothing follows";
}

TEST(LookAhead, PlansTheSameAsAPlantThatPassesNothing) {
  ScriptedPlant passing, other;
  const SessionResult ahead = pack(passing);
  const SessionResult after = session::pack(two_boxes(), "1", quick_options(), other);
  EXPECT_TRUE(other.brought_on_the_way.empty());
  ASSERT_EQ(ahead.items.size(), after.items.size());
  for (std::size_t i = 0; i < ahead.items.size(); ++i) EXPECT_EQ(ahead.items[i].planned, after.items[i].planned);
  EXPECT_EQ(motion::format_program(ahead.program), motion::format_program(after.program));
}

TEST(LookAhead, BringsNothingBeforeWhatWentWrongIsMended) {
  ScriptedPlant plant;
  plant.happens = [&](int motion) {
    if (motion > 1) return plant.visible.clear();
    const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
    plant.visible["BOX027"] = {X_WT.R * exp_rotation(Vector3(0.6, 0.0, 0.0)), X_WT.p + Vector3(0.0, 0.0, 0.22)};
  };
  const SessionResult result = pack(plant);
  EXPECT_FALSE(result.items[0].recoveries.empty());
  EXPECT_EQ(plant.brought, (Names{"BOX027", "BOX028"}));
  EXPECT_TRUE(plant.brought_on_the_way.empty());
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
}

TEST(LookAhead, PlansAnewWhereTheMotionEndedBefore) {
  for (const EndReason reason : {EndReason::ProtectiveStop, EndReason::Timeout}) {
    SCOPED_TRACE(plant::name_of(reason));
    ScriptedPlant plant;
    plant.ends_after_passing = reason;
    const SessionResult result = pack(plant);
    EXPECT_EQ(plant.brought, (Names{"BOX027", "BOX028"})) << "brought once";
    EXPECT_FALSE(result.items[0].recoveries.empty());
    EXPECT_EQ(result.items[1].end, ItemEnd::Placed) << result.items[1].reason;
    EXPECT_EQ(result.items[1].sends.size(), 1U);
  }
}

TEST(LookAhead, ABadPictureOnTheWayIsTakenAgainWhenTheToolStands) {
  ScriptedPlant plant;
  plant.happens = [&](int motion) {
    if (motion == 1) plant.faults = {perception::LookFault::ViewBlocked};
  };
  const SessionResult result = pack(plant);
  EXPECT_TRUE(plant.brought_on_the_way.empty());
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_TRUE(result.items[0].recoveries.empty());
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
  EXPECT_EQ(plant.home_count, 1) << "in the end alone";
}

TEST(LookAhead, AnItemThatDoesNotComeIsSaidWhenItIsItsTurn) {
  ScriptedPlant plant;
  plant.not_brought = {"BOX028"};
  const SessionResult result = pack(plant);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.items[1].end, ItemEnd::NotBrought);
}

TEST(LookAhead, AnotherItemThanExpectedIsRefusedUnplanned) {
  ScriptedPlant plant;
  plant.sizes["BOX028"] = Vector3::Constant(0.3);
  const SessionResult result = pack(plant);
  EXPECT_EQ(plant.brought_on_the_way, Names{"BOX028"});
  EXPECT_EQ(result.items[1].end, ItemEnd::WrongItem);
  EXPECT_EQ(result.items[1].attempts, 0);
}

TEST(LookAhead, AnInterruptedSessionBringsNothingMore) {
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  bool is_interrupted = false;
  options.is_interrupted = [&] { return is_interrupted; };
  plant.happens = [&](int) { is_interrupted = true; };
  const SessionResult result = pack(plant, options);
  EXPECT_EQ(plant.brought, Names{"BOX027"});
  EXPECT_EQ(result.stop_reason, StopReason::Interrupted);
}

TEST(LookAhead, TheRobotWaitsOnlyForWhatTakesLongerThanItsWay) {
  ScriptedPlant plant;
  const SessionResult result = pack(plant);
  const ItemReport &first = result.items[0], &second = result.items[1];
  EXPECT_GE(first.planning_wait, first.decision_seconds + first.rehearsal_seconds) << "nothing moved meanwhile";
  EXPECT_LE(second.planning_wait, std::max(0.0, second.decision_seconds + second.rehearsal_seconds));
}

TEST(LookAhead, WithTheLagTheToolStaysOverTheBox) {
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  options.simulation.tracking = motion::LaggedTracking{};
  const SessionResult result = pack(plant, options);
  EXPECT_TRUE(plant.brought_on_the_way.empty());
  EXPECT_TRUE(std::ranges::none_of(result.program.waypoints,
                                   [](const motion::Waypoint& row) { return row.variant == "_away"; }));
}

}  // namespace
}  // namespace snug::session
