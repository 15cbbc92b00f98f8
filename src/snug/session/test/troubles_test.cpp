// Troubles: what a session says became of an item when its motion was broken off, or what it looks for is not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using plant::EndReason;
using test::has;
using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

SessionResult pack(ScriptedPlant& plant, int items, SessionOptions options = quick_options(),
                   const settings::RehearsalSettings& rehearsal = {}, int most_tries = 4) {
  model::Scenario scenario = two_boxes();
  scenario.rehearsal = rehearsal;
  scenario.recovery.most_tries = most_tries;
  scenario.sequences.front().items.resize(static_cast<std::size_t>(items));
  return session::pack(scenario, "1", options, plant);
}

TEST(Troubles, TakesABoxThatIsNotSeenForPackedWhenItsMotionEnded) {
  ScriptedPlant plant;
  const SessionResult result = pack(plant, 1);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.plan.size(), 1U);
}

TEST(Troubles, DoesNotTakeABoxForPackedThatNeverSealedAndIsNotSeen) {
  ScriptedPlant plant;
  plant.ends.assign(20, EndReason::NoSeal);
  const SessionResult result = pack(plant, 1);
  EXPECT_EQ(result.items[0].end, ItemEnd::NotHeld);
  EXPECT_TRUE(result.plan.empty());
  EXPECT_EQ(result.planned_percent, 0.0);
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
}

TEST(Troubles, DoesNotKnowWhereABoxIsThatFellOrWasLetGoEarlyAndIsNotSeen) {
  for (const EndReason reason : {EndReason::VacuumLost, EndReason::ForceGuard, EndReason::Timeout}) {
    SCOPED_TRACE(plant::name_of(reason));
    ScriptedPlant plant;
    plant.ends = {reason};
    const SessionResult result = pack(plant, 1);
    EXPECT_EQ(result.items[0].end, ItemEnd::Gone);
    EXPECT_TRUE(result.plan.empty());
  }
}

TEST(Troubles, RehearsesAnewWhatWasPickedInVain) {
  ScriptedPlant plant;
  plant.ends = {EndReason::NoSeal};
  settings::RehearsalSettings rehearsal;
  rehearsal.max_attempts = rehearsal.most_attempts = 1;  // used up by the first motion
  const SessionResult result = pack(plant, 1, quick_options(), rehearsal);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
  EXPECT_EQ(result.items[0].sends.size(), 2U);
  EXPECT_EQ(result.items[0].attempts, 2);
}

TEST(Troubles, ReturnsABoxThatMetTooMuchForceAtTheLastTry) {
  ScriptedPlant plant;
  plant.ends = {EndReason::ForceGuard};
  const SessionResult result = pack(plant, 1, quick_options(), {}, 1);
  ASSERT_TRUE(has(result.items[0], Trouble::ForceGuard, Remedy::ReturnToAligner));
  EXPECT_EQ(result.items[0].end, ItemEnd::Returned);
  EXPECT_EQ(result.items[0].reason, "force guard");
  EXPECT_TRUE(result.plan.empty());
  const Pose& X_WA = two_boxes().aligner->X_WA;
  const Vector3 size = model::find_parcel(two_boxes(), "BOX027")->size;
  const Vector3 p_A = X_WA.inverse() * plant.X_WE_let_go.p;
  EXPECT_GT(p_A.head<2>().minCoeff(), 0.0) << "clear of the plates";
  EXPECT_LT(p_A.head<2>().norm(), size.norm());
}

TEST(Troubles, ReturnsABoxThatFellAndLeansWhenPressingDoesNotHelp) {
  ScriptedPlant plant;
  plant.ends = {EndReason::VacuumLost};
  const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion > 1) return;
    plant.visible["BOX027"] = {X_WT.R * exp_rotation(Vector3(0.6, 0.0, 0.0)), X_WT.p + Vector3(0.0, 0.0, 0.22)};
  };
  const SessionResult result = pack(plant, 1);
  EXPECT_EQ(plant.pressed, std::vector<std::string>{"BOX027"});
  EXPECT_TRUE(has(result.items[0], Trouble::Leaning, Remedy::ReturnToAligner));
  EXPECT_EQ(result.items[0].end, ItemEnd::Returned);
}

SessionOptions foresighted_options() {
  SessionOptions options = quick_options();
  options.agent = "contact-aware";
  options.decision.time = 0.2;                               // enough for 64 places, those that cost much among them
  options.future = packing::make_future_model(two_boxes());  // more may come than the order has
  return options;
}

/// Boxes lie as they come: what moved them did not turn them.
settings::RehearsalSettings turns_nothing() {
  settings::RehearsalSettings rehearsal;
  rehearsal.reorientation_cost = rehearsal.side_grasp_cost = 100.0;
  return rehearsal;
}

/// Standing in the middle of the floor, where it is in the way of everything that may come.
Pose middle_of_floor(const std::string& id) {
  const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
  const double height = model::find_parcel(two_boxes(), id)->size.z();
  return {X_WT.R, X_WT.p + Vector3(0.0, 0.0, 0.5 * height)};
}

TEST(Troubles, PicksAgainABoxThatWasMovedToWhereItCostsMuch) {
  ScriptedPlant plant;
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion == 1) plant.visible["BOX027"] = middle_of_floor("BOX027");
  };
  const SessionResult result = pack(plant, 1, foresighted_options(), turns_nothing());
  ASSERT_TRUE(has(result.items[0], Trouble::OffPlace, Remedy::PickAgain));
  EXPECT_NE(result.items[0].recoveries[0].detail.find("% more expected elsewhere"), std::string::npos);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.items[0].sends.size(), 2U);
  ScriptedPlant other;
  other.happens = [&](int) { other.visible["BOX027"] = middle_of_floor("BOX027"); };
  const SessionResult left = pack(other, 1);
  EXPECT_TRUE(has(left.items[0], Trouble::OffPlace, Remedy::Accept)) << "by who does not look ahead";
  EXPECT_EQ(left.items[0].end, ItemEnd::Accepted);
}

TEST(Troubles, PacksANeighbourAnewThatWasMovedToWhereItCostsMuch) {
  ScriptedPlant plant;
  bool is_moved = false;
  plant.happens = [&](int) {
    if (plant.item == "BOX027") plant.visible.clear();
    if (plant.item == "BOX028" && !std::exchange(is_moved, true)) plant.visible["BOX027"] = middle_of_floor("BOX027");
  };
  const SessionResult result = pack(plant, 2, foresighted_options(), turns_nothing());
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_TRUE(has(result.items[1], Trouble::NeighbourMoved, Remedy::PickAgain));
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
  EXPECT_EQ(result.plan.size(), 2U);
  EXPECT_EQ(result.plan.back().item, "BOX027") << "packed after the other one";
}

TEST(Troubles, AFastRobotTurnsABoxOnlyWhereThatIsWorthIt) {
  SessionOptions options = foresighted_options();
  const auto flips = [&](double reorientation_cost) {
    ScriptedPlant plant;
    settings::RehearsalSettings rehearsal;
    rehearsal.reorientation_cost = rehearsal.side_grasp_cost = reorientation_cost;
    const SessionResult result = pack(plant, 1, options, rehearsal);
    EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
    return result.items[0].flips;
  };
  EXPECT_GT(flips(0.0), 0);
  EXPECT_EQ(flips(100.0), 0);
  options.simulation.tracking = motion::LaggedTracking{};
  EXPECT_GT(flips(100.0), 0) << "with the lag it costs nothing";
}

TEST(Troubles, WhatASideGraspCostsCountsWhereOneWillDo) {
  const auto turned = [&](double reorientation_cost, double side_grasp_cost) {
    ScriptedPlant plant;
    settings::RehearsalSettings rehearsal;
    rehearsal.reorientation_cost = reorientation_cost;
    rehearsal.side_grasp_cost = side_grasp_cost;
    return pack(plant, 1, foresighted_options(), rehearsal).items[0].reorientation;
  };
  EXPECT_EQ(turned(100.0, 0.0), skills::Reorientation::SideGrasp);
  EXPECT_EQ(turned(100.0, 100.0), skills::Reorientation::None);
  EXPECT_NE(turned(0.0, 100.0), skills::Reorientation::SideGrasp);
}

/// 25 mm from both plates, on a face that the box does not arrive on: its middle is farther from where it arrived.
Pose at_aligner_on_another_face(const std::string& id) {
  const Pose& X_WA = two_boxes().aligner->X_WA;
  const Vector3 size = model::find_parcel(two_boxes(), id)->size;
  const Pose arrived = X_WA.inverse() * cell::arrival_pose(two_boxes(), two_boxes().sequences.front().items.front());
  const Matrix3 R_AP = exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)) * arrived.R;
  const Vector3 half = 0.5 * (R_AP.cwiseAbs() * size), half_arrived = 0.5 * (arrived.R.cwiseAbs() * size);
  return X_WA * Pose{R_AP, arrived.p - half_arrived + half + Vector3(0.025, 0.025, 0.0)};
}

TEST(Troubles, PlansABoxAnewThatItReturnedToTheAligner) {
  ScriptedPlant plant;
  plant.ends = {EndReason::VacuumLost};
  const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion == 1) {
      plant.visible["BOX027"] = {X_WT.R * exp_rotation(Vector3(0.6, 0.0, 0.0)), X_WT.p + Vector3(0.0, 0.0, 0.22)};
    } else if (motion == 2) {
      plant.visible["BOX027"] = at_aligner_on_another_face("BOX027");
    }
  };
  const SessionResult result = pack(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::Leaning, Remedy::ReturnToAligner));
  EXPECT_EQ(result.items[0].recoveries.back().remedy, Remedy::ReturnToAligner) << "it is seen to be there";
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
  EXPECT_EQ(result.items[0].sends.size(), 2U);
}

TEST(Troubles, AcknowledgesAndGoesOnUntilItsToolIsAway) {
  ScriptedPlant plant;
  plant.ends = {EndReason::VacuumLost};
  plant.retreat_ends = {EndReason::ProtectiveStop, EndReason::ProtectiveStop};
  (void)pack(plant, 1);
  EXPECT_TRUE(plant.retreat_ends.empty());
  EXPECT_GE(plant.acknowledged, 3);
}

TEST(Troubles, ABadPictureIsTakenAgainAndThenBeliefGoesOn) {
  using perception::LookFault;
  ScriptedPlant plant;
  plant.faults = {LookFault::TooFewPoints};
  SessionResult result = pack(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::BadPicture, Remedy::PerceiveAgain));
  EXPECT_FALSE(has(result.items[0], Trouble::BadPicture, Remedy::Believe));
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  ScriptedPlant blind;
  blind.faults.assign(100, LookFault::TooFewPoints);
  result = pack(blind, 2);
  EXPECT_TRUE(has(result.items[0], Trouble::BadPicture, Remedy::Believe));
  EXPECT_EQ(result.plan.size(), 2U) << "as with dead reckoning";
}

TEST(Troubles, TheToolLeavesAViewThatItBlocksAndASessionEndsWhereThatDoesNotHelp) {
  using perception::LookFault;
  ScriptedPlant plant;
  plant.faults = {LookFault::ViewBlocked};
  SessionResult result = pack(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::ViewBlocked, Remedy::MoveAway));
  EXPECT_EQ(plant.home_count, 2) << "once for the view, once in the end";
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  ScriptedPlant blocked;
  blocked.faults.assign(100, LookFault::ViewBlocked);
  result = pack(blocked, 2);
  EXPECT_EQ(result.stop_reason, StopReason::ViewBlocked);
  EXPECT_EQ(result.items.size(), 1U);
  EXPECT_EQ(result.items[0].end, ItemEnd::NotHeld);
  EXPECT_TRUE(has(result.items[0], Trouble::ViewBlocked, Remedy::Stop));
  EXPECT_TRUE(result.plan.empty());
}

TEST(Troubles, ACameraThatGivesNoFrameIsAskedAgainAndThenEndsTheSessionWithItsReason) {
  using perception::LookFault;
  ScriptedPlant plant;
  plant.faults = {LookFault::NoFrame};
  SessionResult result = pack(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::NoFrame, Remedy::PerceiveAgain));
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  ScriptedPlant blind;
  blind.faults.assign(100, LookFault::NoFrame);
  blind.trouble = "the cable is out";
  result = pack(blind, 2);
  EXPECT_EQ(result.stop_reason, StopReason::NoFrame) << "belief alone packs no real cell";
  EXPECT_EQ(result.stopped, "no frame: the cable is out");
  ASSERT_FALSE(result.items[0].recoveries.empty());
  EXPECT_EQ(result.items[0].recoveries.back().detail, "the cable is out");
  EXPECT_TRUE(has(result.items[0], Trouble::NoFrame, Remedy::Stop));
  EXPECT_TRUE(result.plan.empty());
}

TEST(Troubles, ABoxThatIsNotSeenWhereSomethingHigherStandsOverItsPlaceIsGone) {
  ScriptedPlant plant;
  plant.obstacles.emplace();
  plant.happens = [&](int) {
    const model::Container& container = *model::find_container(two_boxes(), two_boxes().target);
    Pose X_WB{Matrix3::Identity(), plant.X_WE_let_go.p};
    X_WB.p.z() = container.X_WT.p.z() + 0.13;
    plant.obstacles = {{perception::columns_of_box(X_WB, {0.15, 0.15, 0.26}), 0.0005}};
  };
  const SessionResult result = pack(plant, 1);
  EXPECT_EQ(result.items[0].end, ItemEnd::Gone);
  EXPECT_TRUE(has(result.items[0], Trouble::Gone, Remedy::Skip));
  EXPECT_TRUE(result.plan.empty());
  ASSERT_EQ(result.obstacles.size(), 1U);
  EXPECT_NEAR(result.obstacles[0].high_T.z(), 0.26, 1e-9);
}

TEST(Troubles, AnotherItemThanTheOneThatWasToComeIsTakenAway) {
  ScriptedPlant plant;
  const model::Parcel& parcel = *model::find_parcel(two_boxes(), "BOX027");
  plant.size = parcel.size - Vector3::Constant(two_boxes().parcel_clearance) + Vector3(0.0, 0.02, 0.0);
  SessionResult result = pack(plant, 1);
  EXPECT_EQ(result.items[0].end, ItemEnd::WrongItem);
  EXPECT_TRUE(has(result.items[0], Trouble::WrongItem, Remedy::Skip));
  EXPECT_EQ(result.items[0].reason, "edges differ by up to 20 mm");
  EXPECT_TRUE(result.plan.empty());
  EXPECT_TRUE(result.items[0].sends.empty());
  ScriptedPlant right;  // within what a tape measure is off
  right.size = *plant.size - Vector3(0.0, 0.0185, 0.0);
  result = pack(right, 1);
  EXPECT_NE(result.items[0].end, ItemEnd::WrongItem);
}

TEST(Troubles, ABoxThatDoesNotStandAtTheAlignerIsGone) {
  ScriptedPlant plant;
  plant.missing = {"BOX027"};
  const SessionResult result = pack(plant, 1);
  EXPECT_EQ(result.items[0].end, ItemEnd::Gone);
  EXPECT_EQ(result.items[0].reason, "gone");
  EXPECT_FALSE(result.percent_before_skips.has_value()) << "it is no item without a place";
}

TEST(Troubles, ABoxThatIsMissingLaterIsNotPackedAnyMore) {
  ScriptedPlant plant;
  plant.happens = [&](int motion) {
    if (motion == 2) plant.missing = {"BOX027"};
  };
  const SessionResult result = pack(plant, 2);
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_EQ(result.items[0].end, ItemEnd::Gone);
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
  ASSERT_EQ(result.plan.size(), 1U);
  EXPECT_EQ(result.plan[0].item, "BOX028");
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
}

TEST(Troubles, PressesOnNothingThatLiesOutsideTheContainer) {
  ScriptedPlant plant;
  const Pose X_WT = model::find_container(two_boxes(), two_boxes().target)->X_WT;
  plant.happens = [&](int) { plant.visible["BOX027"] = {X_WT.R, X_WT.p + Vector3(0.0, 1.0, 0.0)}; };
  const SessionResult result = pack(plant, 1);
  EXPECT_FALSE(result.items[0].is_packed());
  ASSERT_FALSE(result.items[0].recoveries.empty());
  EXPECT_EQ(result.items[0].recoveries[0].trouble, Trouble::OffPlace);
  EXPECT_TRUE(plant.pressed.empty());
}

TEST(Troubles, WhoInterruptsWhenAllIsDoneInterruptsNothing) {
  ScriptedPlant plant;
  bool is_done = false;
  plant.happens = [&](int) { is_done = true; };
  SessionOptions options = quick_options();
  options.is_interrupted = [&] { return is_done; };
  EXPECT_EQ(pack(plant, 1, options).stop_reason, StopReason::AllPacked);
  is_done = false;
  EXPECT_EQ(pack(plant, 2, options).stop_reason, StopReason::Interrupted);
}

}  // namespace
}  // namespace snug::session
