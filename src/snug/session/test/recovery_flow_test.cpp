// Recoveries from end to end: what a session sends, and says of an item, after each way in which a motion can end.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>
#include <utility>

#include "snug/cell/joint_pace.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/planning/belief_json.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using plant::EndReason;
using test::has;
using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

using Edit = std::function<void(model::Scenario&)>;

SessionResult pack_items(ScriptedPlant& plant, std::size_t items, const Edit& edit = {},
                         const SessionOptions& options = quick_options()) {
  model::Scenario scenario = two_boxes();
  scenario.sequences.front().items.resize(items);
  if (edit) edit(scenario);
  return session::pack(scenario, "1", options, plant);
}

Pose container_pose() { return model::find_container(two_boxes(), two_boxes().target)->X_WT; }

/// Standing on the surface where boxes are turned.
Pose on_bench(const std::string& id) {
  const skills::CellLayout layout = skills::make_layout(two_boxes(), cell::find_pan_axis(two_boxes()));
  Pose X_WP = container_pose();
  X_WP.p = layout.flip_place->p_WF + 0.5 * model::find_parcel(two_boxes(), id)->size.z() * Vector3::UnitZ();
  return X_WP;
}

TEST(RecoveryFlow, AStopWithABoxIsAcknowledgedAndTheRestOfTheMotionIsSent) {
  ScriptedPlant plant;
  plant.ends = {EndReason::ProtectiveStop};
  plant.ends_at = motion::MotionClass::PrePlace;
  const SessionResult result = pack_items(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::ProtectiveStop, Remedy::Resume));
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.items[0].sends.size(), 1U) << "the same motion goes on";
  EXPECT_EQ(result.items[0].sends[0].trouble, Trouble::ProtectiveStop);
  EXPECT_EQ(plant.acknowledged, 1);
  ASSERT_EQ(plant.motions.size(), 3U) << "the motion, its rest, home";
  const auto& whole = plant.motions[0].waypoints;
  const auto stopped = std::ranges::find(whole, motion::MotionClass::PrePlace, &motion::Waypoint::motion_class);
  EXPECT_TRUE(std::ranges::equal(plant.motions[1].waypoints, std::vector(stopped, whole.end())));
  EXPECT_EQ(plant.motions[1].guards, plant.motions[0].guards);
}

TEST(RecoveryFlow, ASecondStopLetsTheBoxGo) {
  ScriptedPlant plant;
  plant.ends = {EndReason::ProtectiveStop, EndReason::ProtectiveStop};
  const SessionResult result = pack_items(plant, 1);
  const auto& recoveries = result.items[0].recoveries;
  ASSERT_GE(recoveries.size(), 2U);
  EXPECT_EQ(recoveries[0].remedy, Remedy::Resume);
  EXPECT_EQ(recoveries[1].remedy, Remedy::Release);
  EXPECT_EQ(result.items[0].end, ItemEnd::Gone) << "let go somewhere, and not seen";
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
  const auto& up = plant.motions[2].waypoints;
  EXPECT_TRUE(up.front().io.blow_off);
  EXPECT_FALSE(up.back().io.vacuum);
  EXPECT_GE(up.back().X_WE.p.z(), up.front().X_WE.p.z());
}

TEST(RecoveryFlow, StopsThatDoNotEndEndTheSession) {
  ScriptedPlant plant;
  plant.ends.assign(100, EndReason::ProtectiveStop);
  plant.retreat_ends.assign(100, EndReason::ProtectiveStop);
  const SessionResult result = pack_items(plant, 2);
  EXPECT_EQ(result.stop_reason, StopReason::RobotStops);
  EXPECT_EQ(result.stopped, "robot stops");
  EXPECT_EQ(plant.brought, std::vector<std::string>{"BOX027"}) << "no further item";
  EXPECT_FALSE(result.items[0].is_packed());
  EXPECT_LT(plant.motions.size(), 30U);
}

TEST(RecoveryFlow, NeverSendsMoreMotionsForAnItemThanItMay) {
  for (int most = 1; most <= 5; ++most) {
    SCOPED_TRACE(most);
    ScriptedPlant plant;
    plant.ends.assign(100, EndReason::NoSeal);
    const SessionResult result = pack_items(plant, 1, [&](auto& scenario) { scenario.recovery.most_tries = most; });
    EXPECT_EQ(result.items[0].sends.size(), static_cast<std::size_t>(most));
    EXPECT_EQ(result.items[0].end, ItemEnd::NotHeld);
    EXPECT_EQ(result.items[0].reason, "no seal");
    for (const Send& send : result.items[0].sends) EXPECT_EQ(send.end.reason, EndReason::NoSeal);
  }
}

TEST(RecoveryFlow, LoadAndLatenessPutABoxDownOnTheBenchAndPickItThere) {
  for (const EndReason reason : {EndReason::ForceGuard, EndReason::HoldGuard, EndReason::Timeout}) {
    SCOPED_TRACE(plant::name_of(reason));
    ScriptedPlant plant;
    plant.ends = {reason};
    plant.happens = [&](int motion) {
      plant.visible.clear();
      if (motion == 2) plant.visible["BOX027"] = on_bench("BOX027");
    };
    const SessionResult result = pack_items(plant, 1);
    ASSERT_EQ(result.items[0].recoveries.size(), 1U);
    EXPECT_EQ(result.items[0].recoveries[0].remedy, Remedy::SetDown);
    EXPECT_EQ(result.items[0].sends.size(), 2U);
    EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
    const skills::CellLayout layout = skills::make_layout(two_boxes(), cell::find_pan_axis(two_boxes()));
    const auto& down = plant.motions[1].waypoints;
    double nearest = 10.0;
    for (const motion::Waypoint& row : down) {
      nearest = std::min(nearest, (row.X_WE.p - layout.flip_place->p_WF).head<2>().norm());
    }
    EXPECT_LT(nearest, 0.1) << "over the bench";
    EXPECT_TRUE(down.front().io.vacuum);
    EXPECT_FALSE(down.back().io.vacuum);
  }
}

TEST(RecoveryFlow, AFaultOfThePlantEndsTheSessionAtOnce) {
  for (const EndReason reason : {EndReason::Fault, EndReason::Refused}) {
    ScriptedPlant plant;
    plant.ends = {reason};
    const SessionResult result = pack_items(plant, 2);
    EXPECT_EQ(result.stop_reason, StopReason::PlantFault);
    EXPECT_EQ(plant.brought.size(), 1U);
    EXPECT_TRUE(has(result.items[0], Trouble::PlantFault, Remedy::Stop));
    EXPECT_FALSE(result.items[0].is_packed());
    EXPECT_TRUE(result.plan.empty());
  }
}

TEST(RecoveryFlow, AnItemThatDoesNotComeIsNoReasonToStop) {
  ScriptedPlant plant;
  plant.not_brought = {"BOX027"};
  const SessionResult result = pack_items(plant, 2);
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_EQ(result.items[0].end, ItemEnd::NotBrought);
  EXPECT_TRUE(result.items[0].sends.empty());
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
}

TEST(RecoveryFlow, ARobotThatDoesNotComeHomeIsAFailureWhateverWasPacked) {
  ScriptedPlant plant;
  plant.home_ends = {EndReason::ProtectiveStop};
  const SessionResult result = pack_items(plant, 1);
  EXPECT_EQ(result.stop_reason, StopReason::AllPacked);
  EXPECT_EQ(result.failure.kind, SessionFailureKind::NotHome);
  EXPECT_NE(result.failure.text.find("protective stop"), std::string::npos) << result.failure.text;
  EXPECT_NE(result.stopped.find(result.failure.text), std::string::npos);
  EXPECT_EQ(result.plan.size(), 1U);
}

/// An insertion that load ended says that boxes are harder: from then on they are twice as stiff, four times at most.
TEST(RecoveryFlow, LoadOnTheWayInMakesBoxesStifferInTheBeliefAndLoadElsewhereDoesNot) {
  const auto stiffness_after = [](EndReason reason, motion::MotionClass where) {
    ScriptedPlant plant;
    plant.ends = {reason};
    plant.ends_at = where;
    SessionOptions options = quick_options();
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "stiffer";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    options.save_beliefs = folder;
    std::string last;
    options.log = [&](const SessionEvent& one) {
      if (const auto* planned = std::get_if<event::Planned>(&one)) last = planned->belief_file;
    };
    (void)session::pack(two_boxes(), "1", options, plant);
    const planning::BeliefSnapshot belief = planning::load_request(folder / last).belief;
    EXPECT_EQ(belief.items[belief.sent.empty() ? 0 : 1].id, "BOX028") << "the item after";
    return *belief.nominal().contact_pairs.front().params.stiffness /
           *two_boxes().contact_pairs.front().params.stiffness;
  };
  const double stiffer = two_boxes().belief.stiffer;
  for (const EndReason reason :
       {EndReason::ForceGuard, EndReason::HoldGuard, EndReason::VacuumLost, EndReason::ProtectiveStop}) {
    EXPECT_NEAR(stiffness_after(reason, motion::MotionClass::Place), stiffer, 1e-9) << plant::name_of(reason);
    EXPECT_NEAR(stiffness_after(reason, motion::MotionClass::PrePlace), 1.0, 1e-9) << plant::name_of(reason);
  }
  EXPECT_NEAR(stiffness_after(EndReason::Timeout, motion::MotionClass::Place), 1.0, 1e-9) << "that is no load";
}

/// All of the container is foreign: nothing has a place.
std::vector<perception::Obstacle> full_container() {
  const model::Container& container = *model::find_container(two_boxes(), two_boxes().target);
  Pose X_WB = container.X_WT;
  X_WB.p.z() += 0.5 * container.inner_size.z();
  return {{perception::columns_of_box(X_WB, container.inner_size), 0.0005}};
}

TEST(RecoveryFlow, ItemsWithoutAPlaceAreSkippedAsManyAsMayBe) {
  for (int skips = 0; skips <= 2; ++skips) {
    SCOPED_TRACE(skips);
    ScriptedPlant plant;
    plant.obstacles = full_container();
    SessionOptions options = quick_options();
    options.skips = skips;
    const SessionResult result = pack_items(plant, 2, {}, options);
    EXPECT_EQ(result.items.size(), static_cast<std::size_t>(std::min(2, skips + 1)));
    EXPECT_EQ(result.stop_reason, skips < 2 ? StopReason::NoPlace : StopReason::NoMoreItems);
    for (const ItemReport& item : result.items) EXPECT_EQ(item.end, ItemEnd::NoPlace) << item.reason;
    EXPECT_EQ(result.percent_before_skips, 0.0);
    EXPECT_TRUE(plant.motions.empty()) << "not even home: it never left";
    EXPECT_FALSE(result.failure);
  }
}

TEST(RecoveryFlow, WithSkipsForAllItemsAnOrderIsPackedAsFarAsItFits) {
  ScriptedPlant plant;
  plant.obstacles = full_container();
  const SessionResult result = pack_items(plant, 2, [](auto& scenario) { scenario.recovery.skips = 1000; });
  EXPECT_EQ(result.items.size(), 2U);
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
  EXPECT_FALSE(result.failure);
}

TEST(RecoveryFlow, AnItemThatFitsNowhereEverUsesUpNoSkip) {
  ScriptedPlant plant;
  SessionOptions options = quick_options();
  options.skips = 0;
  const SessionResult heavy = pack_items(
      plant, 2,
      [](auto& scenario) {
        const auto box = std::ranges::find(scenario.parcels, "BOX027", &model::Parcel::id);
        box->inertia.mass = 2.0 * scenario.packing.max_item_mass;
      },
      options);
  ASSERT_EQ(heavy.items.size(), 2U);
  EXPECT_EQ(heavy.items[0].end, ItemEnd::Infeasible);
  EXPECT_EQ(heavy.items[0].reason, packing::describe(packing::NoPlace::TooHeavy));
  EXPECT_EQ(heavy.items[1].end, ItemEnd::Placed);
  EXPECT_FALSE(heavy.percent_before_skips);
  EXPECT_EQ(heavy.stop_reason, StopReason::NoMoreItems);
}

TEST(RecoveryFlow, AnItemThatTheCupCannotCarrySaysWhatWould) {
  ScriptedPlant plant;
  const SessionResult result = pack_items(plant, 2, [](auto& scenario) {
    std::ranges::find(scenario.parcels, "BOX027", &model::Parcel::id)->inertia.mass =
        0.8 * scenario.packing.max_item_mass;
    scenario.cup.vacuum.pressure_gauge_hold *= 0.6;
  });
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_EQ(result.items[0].end, ItemEnd::Infeasible);
  for (const char* part : {"place_limits.hold_factor", "cup.effective_diameter", "cup.vacuum.pressure_gauge_hold"}) {
    EXPECT_NE(result.items[0].reason.find(part), std::string::npos) << result.items[0].reason;
  }
  EXPECT_EQ(result.items[1].end, ItemEnd::Placed);
}

TEST(RecoveryFlow, ABoxThatFellBesideTheContainerIsPickedThere) {
  ScriptedPlant plant;
  plant.ends = {EndReason::VacuumLost};
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion == 1) plant.visible["BOX027"] = on_bench("BOX027");
  };
  const SessionResult result = pack_items(plant, 1);
  EXPECT_TRUE(has(result.items[0], Trouble::VacuumLost, Remedy::PickAgain));
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
  EXPECT_EQ(result.items[0].sends.size(), 2U);
}

/// Where the only item is planned to stand.
Pose planned_pose() {
  ScriptedPlant plant;
  return container_pose() * pack_items(plant, 1).items[0].planned.X_TP;
}

TEST(RecoveryFlow, ABoxThatLeansIsPressedFromAboveAndIsPlacedWhenItStandsLevelThen) {
  ScriptedPlant plant;
  const Pose X_WP = planned_pose();
  const Pose leaning{exp_rotation(Vector3(0.2, 0.0, 0.0)) * X_WP.R, X_WP.p};
  plant.happens = [&](int) { plant.visible["BOX027"] = leaning; };
  plant.when_pressed = [&] { plant.visible["BOX027"] = X_WP; };
  const SessionResult result = pack_items(plant, 1);
  ASSERT_EQ(result.items[0].recoveries.size(), 1U);
  EXPECT_EQ(result.items[0].recoveries[0].trouble, Trouble::Leaning);
  EXPECT_EQ(result.items[0].recoveries[0].remedy, Remedy::PressLevel);
  EXPECT_EQ(plant.pressed.size(), 1U);
  EXPECT_EQ(result.items[0].sends.size(), 1U);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_NEAR(result.items[0].position_error, 0.0, 1e-9);
  EXPECT_NEAR(result.items[0].angle_error, 0.0, 1e-6) << "as it was seen last";
  const auto press = std::ranges::find_if(plant.motions, [](const plant::Motion& motion) {
    return std::ranges::any_of(motion.waypoints, [](const auto& row) { return row.variant == "_press"; });
  });
  ASSERT_NE(press, plant.motions.end());
  EXPECT_EQ(press->guards.force, two_boxes().skills.press.force);
  EXPECT_FALSE(press->guards.vacuum);
}

TEST(RecoveryFlow, ABoxThatLeansForEverIsPressedOnceForEachMotionAndThenGivenUp) {
  ScriptedPlant plant;
  plant.happens = [&](int) {
    Pose X_WP = container_pose();
    X_WP.p += Vector3(0.0, 0.0, 0.06);
    plant.visible["BOX027"] = {X_WP.R * exp_rotation(Vector3(0.2, 0.0, 0.0)), X_WP.p};
  };
  const SessionResult result = pack_items(plant, 1);
  EXPECT_LE(plant.pressed.size(), result.items[0].sends.size());
  EXPECT_LE(result.items[0].sends.size(), static_cast<std::size_t>(two_boxes().recovery.most_tries));
  EXPECT_FALSE(result.items[0].end == ItemEnd::Placed);
}

/// Just within and just beyond the limits of 20 mm and 6 degrees.
TEST(RecoveryFlow, ABoxIsPlacedWithinTheLimitsAndOffItsPlaceBeyondThem) {
  const Pose X_WP = planned_pose();
  const settings::PlaceLimits& limits = two_boxes().place_limits;
  const auto trouble_of = [&](const Vector3& shift, double yaw) {
    ScriptedPlant plant;
    plant.happens = [&](int) {
      plant.visible["BOX027"] = {exp_rotation(Vector3(0.0, 0.0, yaw)) * X_WP.R, X_WP.p + shift};
    };
    const SessionResult result = pack_items(plant, 1);
    EXPECT_NEAR(result.items[0].position_error, shift.head<2>().norm(), 1e-9);
    EXPECT_NEAR(result.items[0].angle_error, std::abs(yaw), 1e-6);
    EXPECT_EQ(result.items[0].end, result.items[0].recoveries.empty() ? ItemEnd::Placed : ItemEnd::Accepted);
    return result.items[0].sends[0].trouble;
  };
  EXPECT_EQ(trouble_of(Vector3(0.99 * limits.position, 0.0, 0.0), 0.0), Trouble::None);
  EXPECT_EQ(trouble_of(Vector3(0.0, 1.01 * limits.position, 0.0), 0.0), Trouble::OffPlace);
  EXPECT_EQ(trouble_of(Vector3(0.0, 0.0, 0.005), 0.0), Trouble::None) << "level distance counts";
  EXPECT_EQ(trouble_of(Vector3::Zero(), 0.99 * limits.tilt), Trouble::None);
  EXPECT_EQ(trouble_of(Vector3::Zero(), -1.01 * limits.tilt), Trouble::OffPlace) << "it lies flat";
}

/// The first box stands 10 mm beyond a wall after the second one came: on it, or at the other end of the container.
TEST(RecoveryFlow, ABoxUnderAnotherIsNotPickedAgain) {
  const model::Scenario& scenario = two_boxes();
  const Pose X_WT = container_pose();
  const Vector3 inner = model::find_container(scenario, scenario.target)->inner_size;
  const Vector3 size = model::find_parcel(scenario, "BOX027")->size;
  const Vector3 beyond(0.5 * (inner.x() - size.x()) + 0.010, 0.0, 0.5 * size.z());
  for (const bool is_under : {true, false}) {
    SCOPED_TRACE(is_under);
    ScriptedPlant plant;
    plant.happens = [&](int motion) {
      if (motion != 2) return;
      const Vector3 on_it = beyond + Vector3(-0.015, 0.0, size.z()), far(0.0, -0.15, 0.5 * size.z());
      plant.visible["BOX027"] = {X_WT.R, X_WT * beyond};
      plant.visible["BOX028"] = {X_WT.R, X_WT * (is_under ? on_it : far)};
    };
    const SessionResult result = pack_items(plant, 2);
    const auto picks = std::ranges::count_if(plant.motions, [](const plant::Motion& motion) {
      const bool holds = std::ranges::any_of(motion.waypoints, [](const auto& row) { return row.io.vacuum; });
      return holds && motion.item.value == "BOX027";
    });
    EXPECT_EQ(has(result.items[1], Trouble::SticksOut, Remedy::PickAgain), !is_under);
    if (is_under) {
      EXPECT_TRUE(has(result.items[1], Trouble::SticksOut, Remedy::Skip));
      EXPECT_EQ(picks, 1) << "when it was packed";
      EXPECT_FALSE(result.items[0].is_packed()) << "it still sticks out";
    } else {
      EXPECT_GT(picks, 1);
    }
  }
}

TEST(RecoveryFlow, ANeighbourThatLeansWhateverIsDoneIsNotCountedInTheEnd) {
  ScriptedPlant plant;
  plant.happens = [&](int) {
    if (plant.item != "BOX028" && plant.visible.empty()) return;
    Pose X_WP = container_pose();
    X_WP.R = X_WP.R * exp_rotation(Vector3(0.35, 0.0, 0.0));
    X_WP.p.z() += model::find_parcel(two_boxes(), "BOX027")->size.z();
    plant.visible["BOX027"] = X_WP;
  };
  const SessionResult result = pack_items(plant, 2);
  EXPECT_FALSE(plant.pressed.empty()) << "something was tried";
  EXPECT_EQ(result.items[0].end, ItemEnd::Rejected) << describe(result.items[0]);
  EXPECT_NE(result.items[0].reason.find("leans by 20.1 degrees"), std::string::npos) << result.items[0].reason;
  EXPECT_EQ(rejected_items(result), std::vector<std::string>{"BOX027 " + result.items[0].reason});
  EXPECT_EQ(result.stop_reason, StopReason::NoMoreItems);
  const model::Scenario scenario = two_boxes();
  const model::Container& container = *model::find_container(scenario, scenario.target);
  EXPECT_NEAR(result.planned_percent, model::compute_filling_degree_percent(scenario, container, {"BOX028"}), 1e-9);
}

/// A box that is found leaning when the robot is home, though it stood when it was let go.
struct LeansInTheEnd {
  ScriptedPlant plant;
  Pose upright = planned_pose(), leaning{upright.R * exp_rotation(Vector3(0.2, 0.0, 0.0)), upright.p};

  SessionResult pack() {
    SessionOptions options = quick_options();
    options.log = [this](const SessionEvent& one) {
      const bool has_ended = std::holds_alternative<event::MotionEnded>(one);
      if (has_ended && plant.home_count == 1 && plant.pressed.empty()) plant.visible["BOX027"] = leaning;
    };
    plant.visible["BOX027"] = upright;
    return pack_items(plant, 1, {}, options);
  }
};

TEST(RecoveryFlow, ABoxThatLeansInTheEndIsPressedAndAccepted) {
  LeansInTheEnd load;
  load.plant.when_pressed = [&] { load.plant.visible["BOX027"] = load.upright; };
  const SessionResult result = load.pack();
  EXPECT_EQ(load.plant.pressed, std::vector<std::string>{"BOX027"});
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed) << result.items[0].reason;
  EXPECT_TRUE(rejected_items(result).empty());
  EXPECT_EQ(load.plant.home_count, 2) << "and home again";
}

TEST(RecoveryFlow, ABoxThatLeansInTheEndWhateverIsDoneIsTakenOut) {
  LeansInTheEnd load;
  load.plant.happens = [&](int motion) {
    if (motion == 2) load.plant.visible["BOX027"] = on_bench("BOX027");
  };
  const SessionResult result = load.pack();
  EXPECT_EQ(load.plant.pressed.size(), 1U);
  EXPECT_EQ(result.items[0].end, ItemEnd::TakenOut);
  EXPECT_EQ(result.items[0].reason, "leans by 11.5 degrees (6.0 are allowed): it is put on the bench");
  EXPECT_TRUE(rejected_items(result).empty()) << "what is left is a finished load";
  EXPECT_TRUE(result.plan.empty());
}

/// Between the 5 mm of a finished load and the 12 mm of a box that is packed.
TEST(RecoveryFlow, ABoxThatStandsALittleOverTheRimIsPressedAtOnce) {
  const Pose X_WP = planned_pose();
  const double height = model::find_parcel(two_boxes(), "BOX027")->size.z();
  const double inner = model::find_container(two_boxes(), two_boxes().target)->inner_size.z();
  const auto pack_with = [&](double over) {
    ScriptedPlant plant;
    plant.happens = [&](int) {
      Pose high = X_WP;
      high.p.z() = container_pose().p.z() + inner + over - 0.5 * height;
      plant.visible["BOX027"] = high;
    };
    plant.when_pressed = [&] { plant.visible["BOX027"] = X_WP; };
    return pack_items(plant, 1);
  };
  const SessionResult high = pack_with(0.008), low = pack_with(0.004);
  EXPECT_TRUE(has(high.items[0], Trouble::SticksOut, Remedy::PressLevel));
  EXPECT_EQ(recovery_count(low), 0);
}

TEST(RecoveryFlow, AnItemOnTheBenchWhenTheViewIsBlockedIsNoItemWithoutAPlace) {
  ScriptedPlant plant;
  plant.ends = {EndReason::HoldGuard};
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion < 2) return;
    plant.visible["BOX027"] = on_bench("BOX027");
    plant.faults.assign(3, perception::LookFault::ViewBlocked);
  };
  SessionOptions options = quick_options();
  options.skips = 0;
  const SessionResult result = pack_items(plant, 1, {}, options);
  EXPECT_EQ(result.stop_reason, StopReason::ViewBlocked) << result.stopped;
  EXPECT_EQ(result.items[0].end, ItemEnd::Left);
  EXPECT_EQ(result.items[0].reason, "view blocked");
  EXPECT_FALSE(result.percent_before_skips);
}

/// A packed box is found in the middle of the floor, and goes to another place.
TEST(RecoveryFlow, TheTimeForABoxThatIsPackedAnewCountsForTheItemThatMovedIt) {
  ScriptedPlant plant;
  bool is_moved = false;
  plant.happens = [&](int) {
    if (plant.item == "BOX027") plant.visible.clear();
    if (plant.item != "BOX028" || std::exchange(is_moved, true)) return;
    plant.visible["BOX027"] = container_pose();
    plant.visible["BOX027"].p.z() += 0.5 * model::find_parcel(two_boxes(), "BOX027")->size.z();
  };
  SessionOptions options = quick_options();
  options.agent = "contact-aware";
  options.decision.time = 0.02;
  options.future = packing::make_future_model(two_boxes());  // more may come than the order has
  const SessionResult result = pack_items(plant, 2, {}, options);
  ASSERT_TRUE(has(result.items[1], Trouble::NeighbourMoved, Remedy::PickAgain));
  for (const ItemReport& item : result.items) EXPECT_NEAR(item.seconds.total(), item.done - item.begin, 1e-9);
  EXPECT_GE(result.items[1].seconds.total(), 2.0) << "s: two motions";
}

/// Two boxes fit one behind the other. When the second comes, the first is found in the middle.
TEST(RecoveryFlow, APackedBoxMovesWhereAnItemHasNoPlaceOtherwise) {
  const auto edit = [](model::Scenario& scenario) {
    std::ranges::find(scenario.containers, scenario.target, &model::Container::name)->inner_size =
        Vector3(0.185, 0.490, 0.120);
    scenario.recovery.skips = 0;
  };
  const auto pack_with = [&](const std::string& agent) {
    ScriptedPlant plant;
    SessionOptions options = quick_options();
    options.agent = agent;
    options.decision.time = 0.02;
    options.log = [&](const SessionEvent& one) {
      const auto* brought = std::get_if<event::ItemBrought>(&one);
      if (brought == nullptr || brought->item != model::ItemIndex(1)) return;
      plant.visible["BOX027"] = container_pose();
      plant.visible["BOX027"].p.z() += 0.047;
    };
    plant.happens = [&](int) { plant.visible.clear(); };
    return pack_items(plant, 2, edit, options);
  };
  const SessionResult moved = pack_with("contact-aware");
  ASSERT_EQ(moved.items.size(), 2U);
  EXPECT_EQ(moved.stop_reason, StopReason::AllPacked);
  for (const ItemReport& item : moved.items) {
    EXPECT_EQ(item.end, ItemEnd::Placed) << item.id << ": " << item.reason;
    EXPECT_EQ(item.sends.size(), 1U) << "the other box's motion is not its own";
    EXPECT_NEAR(item.seconds.total(), item.done - item.begin, 1e-9);
  }
  EXPECT_EQ(recovery_count(moved), 0);
  EXPECT_TRUE(moved.items[0].made_room.empty());
  ASSERT_EQ(moved.items[1].made_room.size(), 1U);
  EXPECT_EQ(moved.items[1].made_room[0].item, "BOX027");
  EXPECT_EQ(moved.items[0].planned, moved.items[1].made_room[0]);
  EXPECT_EQ(moved.plan.size(), 2U);
  const SessionResult stays = pack_with("margin");
  ASSERT_EQ(stays.items.size(), 2U);
  EXPECT_FALSE(stays.items[1].is_packed()) << "it does not look ahead";
}

/// The floor has room for one box, and nothing may stand on the first.
TEST(RecoveryFlow, APackedBoxWaitsOnTheBenchUntilTheItemStands) {
  const auto edit = [](model::Scenario& scenario) {
    std::ranges::find(scenario.containers, scenario.target, &model::Container::name)->inner_size =
        Vector3(0.177, 0.250, 0.200);
    std::ranges::find(scenario.parcels, "BOX027", &model::Parcel::id)->handling.no_stack = true;
    scenario.packing.last_interference = scenario.packing.planned_interference;
    scenario.recovery.skips = 0;
  };
  ScriptedPlant plant;
  plant.happens = [&](int motion) {
    plant.visible.clear();
    if (motion == 2 || motion == 3) plant.visible["BOX027"] = on_bench("BOX027");
  };
  SessionOptions options = quick_options();
  options.agent = "contact-aware";
  options.decision.time = 0.02;
  const SessionResult result = pack_items(plant, 2, edit, options);
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_EQ(result.stop_reason, StopReason::AllPacked) << result.stopped;
  for (const ItemReport& item : result.items) {
    EXPECT_EQ(item.end, ItemEnd::Placed) << item.id << ": " << item.reason;
    EXPECT_EQ(item.sends.size(), 1U) << "what the other box took is not its own";
    EXPECT_NEAR(item.seconds.total(), item.done - item.begin, 1e-9);
  }
  ASSERT_EQ(result.items[1].made_room.size(), 1U);
  EXPECT_EQ(result.items[1].made_room[0].item, "BOX027");
  EXPECT_EQ(result.items[0].planned, result.items[1].made_room[0]);
  EXPECT_GT(result.items[0].planned.X_TP.p.z(), result.items[1].planned.X_TP.p.z()) << "on the item";
  EXPECT_EQ(result.plan.size(), 2U);
}

// What holds of every session, whatever happens in its plant.

/// Ends and sights at random: boxes lie in the container, on the bench, on the ground, lean, or are not seen.
void make_mischief(ScriptedPlant& plant, Rng& rng) {
  constexpr std::array kReasons{EndReason::Completed,  EndReason::ForceGuard,     EndReason::HoldGuard,
                                EndReason::NoSeal,     EndReason::VacuumLost,     EndReason::ProtectiveStop,
                                EndReason::Completed,  EndReason::Timeout,        EndReason::Completed,
                                EndReason::VacuumLost, EndReason::ProtectiveStop, EndReason::Fault};
  const auto any = [&](int count) { return kReasons[static_cast<std::size_t>(rng.index(count))]; };
  for (int i = 0; i < 200; ++i) plant.ends.push_back(any(rng.index(8) == 0 ? 12 : 11));
  for (int i = 0; i < 200; ++i) plant.retreat_ends.push_back(rng.index(4) == 0 ? any(8) : EndReason::Completed);
  for (int i = 0; i < 50; ++i) {
    plant.faults.push_back(rng.index(6) == 0 ? static_cast<perception::LookFault>(1 + rng.index(2))
                                             : perception::LookFault::None);
  }
  plant.happens = [&plant, &rng](int) {
    const Pose X_WT = container_pose();
    for (const std::string id : {"BOX027", "BOX028"}) {
      plant.visible.erase(id);
      plant.missing.erase(id);
      const double lean = rng.index(3) == 0 ? rng.uniform(-0.7, 0.7) : 0.0;
      const Matrix3 R = X_WT.R * exp_rotation(Vector3(lean, 0.0, 0.0));
      switch (rng.index(6)) {
        case 0:
          plant.visible[id] = {
              R, X_WT.p + Vector3(rng.uniform(-0.1, 0.1), rng.uniform(-0.2, 0.2), rng.uniform(0.04, 0.3))};
          break;
        case 1:
          plant.visible[id] = on_bench(id);
          break;
        case 2:
          plant.visible[id] = {R, Vector3(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), -0.75)};
          break;
        case 3:
          plant.missing.insert(id);
          break;
        default:
          break;
      }
    }
  };
}

void expect_sound(const SessionResult& result, const ScriptedPlant& plant, const model::Scenario& scenario) {
  std::vector<motion::Waypoint> sent;
  for (const plant::Motion& motion : plant.motions) {
    sent.insert(sent.end(), motion.waypoints.begin(), motion.waypoints.end());
    ASSERT_FALSE(motion.waypoints.empty());
  }
  EXPECT_EQ(result.program.waypoints, sent) << "every waypoint that was sent";
  for (const motion::Waypoint& row : sent) EXPECT_TRUE(row.X_WE.p.allFinite() && row.X_WE.R.allFinite());
  std::set<std::string> planned, packed, seen;
  for (const packing::Placement& one : result.plan) EXPECT_TRUE(planned.insert(one.item).second) << "planned twice";
  for (const ItemReport& item : result.items) {
    SCOPED_TRACE(item.id + " " + describe(item));
    EXPECT_TRUE(seen.insert(item.id).second);
    if (item.is_packed()) packed.insert(item.id);
    EXPECT_LE(item.sends.size(), static_cast<std::size_t>(scenario.recovery.most_tries));
    EXPECT_NEAR(item.seconds.total(), item.done - item.begin, 1e-9);
    EXPECT_TRUE(item.is_packed() || !item.reason.empty()) << "why not";
    for (const Send& send : item.sends) {
      EXPECT_GE(send.predicted_success, 0.0);
      EXPECT_LE(send.predicted_success, 1.0);
      EXPECT_GE(send.time, item.begin);
      EXPECT_LE(send.time, item.done);
      EXPECT_EQ(send.planned.item, item.id);
    }
    double last = item.begin;
    for (const Recovery& one : item.recoveries) {
      EXPECT_GE(one.time, last);
      EXPECT_NE(one.trouble, Trouble::None);
      EXPECT_NE(one.remedy, Remedy::None);
      last = one.time;
    }
  }
  EXPECT_EQ(planned, packed);
  EXPECT_EQ(result.stop_reason == StopReason::AllPacked, packed.size() == 2U && result.items.size() == 2U);
  EXPECT_FALSE(result.stopped.empty());
  const model::Container& container = *model::find_container(scenario, scenario.target);
  EXPECT_NEAR(result.planned_percent,
              model::compute_filling_degree_percent(scenario, container, {packed.begin(), packed.end()}), 1e-9);
  EXPECT_LT(plant.motions.size(), 200U) << "it ends";
}

TEST(RecoveryFlow, HoldsItsPromisesWhateverHappens) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng = Rng(seed).split("mischief");
    ScriptedPlant plant;
    make_mischief(plant, rng);
    const SessionResult result = pack_items(plant, 2);
    expect_sound(result, plant, two_boxes());
  }
}

TEST(RecoveryFlow, TheSameHappeningsGiveTheSameSession) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<SessionResult> results;
    for (const int threads : {1, 2}) {
      Rng rng = Rng(seed).split("mischief");
      ScriptedPlant plant;
      make_mischief(plant, rng);
      SessionOptions options = quick_options();
      options.threads = threads;
      options.samples = 2;
      results.push_back(pack_items(plant, 2, {}, options));
    }
    EXPECT_EQ(results[0].program.waypoints, results[1].program.waypoints) << seed;
    EXPECT_EQ(results[0].plan, results[1].plan);
    ASSERT_EQ(results[0].items.size(), results[1].items.size());
    for (std::size_t i = 0; i < results[0].items.size(); ++i) {
      EXPECT_EQ(describe(results[0].items[i]), describe(results[1].items[i]));
      EXPECT_EQ(results[0].items[i].success_rate, results[1].items[i].success_rate);
      EXPECT_EQ(results[0].items[i].recoveries.size(), results[1].items[i].recoveries.size());
    }
  }
}

}  // namespace
}  // namespace snug::session
