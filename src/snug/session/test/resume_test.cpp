// Resumed sessions: what was done with stays, the rest comes, and the log is of the whole.
#include "snug/session/resume.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/session/session.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

/// All events of a session of two boxes that nothing disturbs.
EventLog whole_log() {
  ScriptedPlant plant;
  EventLog log;
  SessionOptions options = quick_options();
  options.log = [&](const SessionEvent& one) { log.events.push_back(one); };
  (void)session::pack(two_boxes(), "1", options, plant);
  return log;
}

/// Up to the event of this kind that is the `count`-th.
template <class Kind>
EventLog killed_after(EventLog log, int count) {
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    if (std::holds_alternative<Kind>(log.events[i]) && --count == 0) {
      log.events.resize(i + 1);
      return log;
    }
  }
  ADD_FAILURE() << "no such event";
  return log;
}

TEST(Resume, BringsOnlyWhatWasNotDoneWith) {
  SessionOptions options = quick_options();
  EventLog told;
  options.log = [&](const SessionEvent& one) { told.events.push_back(one); };
  options.resume = find_resume_point(killed_after<event::MotionStarted>(whole_log(), 2), "log");
  ASSERT_EQ(options.resume->item_count(), 1);
  ASSERT_EQ(options.resume->boxes.size(), 1U);
  ScriptedPlant plant;
  std::vector<int> numbers;
  const SessionResult result =
      session::pack(two_boxes(), "1", options, plant, [&](const SessionResult&, int item, int items) {
        numbers.push_back(item);
        EXPECT_EQ(items, 2);
      });
  EXPECT_EQ(plant.brought, (std::vector<std::string>{"BOX028"}));
  EXPECT_EQ(numbers, (std::vector<int>{1, 2}));
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_TRUE(result.items[0].is_packed() && result.items[1].is_packed());
  EXPECT_EQ(result.stop_reason, StopReason::AllPacked);
  const ResumePoint end = [&] {
    EventLog before_the_end = killed_after<event::Counted>(told, 2);
    return find_resume_point(before_the_end, "told");
  }();
  EXPECT_EQ(end.item_count(), 2) << "its own log can be gone on with";
}

TEST(Resume, ASessionThatIsKilledBeforeItsFirstItemIsDoneBeginsAnew) {
  SessionOptions options = quick_options();
  options.resume = find_resume_point(killed_after<event::MotionStarted>(whole_log(), 1), "log");
  EXPECT_EQ(options.resume->item_count(), 0);
  ScriptedPlant plant;
  EXPECT_EQ(session::pack(two_boxes(), "1", options, plant).items.size(), 2U);
  EXPECT_EQ(plant.brought.size(), 2U);
}

/// The robot stands where the session before ended: with the second box in the cup, 0.2 m over the container.
struct TakenOver {
  TakenOver() {
    options = quick_options();
    options.resume = find_resume_point(killed_after<event::MotionStarted>(whole_log(), 2), "log");
    options.takes_over = true;
    const model::Scenario& scenario = two_boxes();
    plant::Feedback& robot = plant.sensors();
    robot.X_WE.p = model::find_container(scenario, scenario.target)->X_WT.p + Vector3(0.0, 0.0, 0.5);
    robot.io.vacuum = true;
    robot.pressure_gauge = -6.0e4;
    const model::Parcel& parcel = *model::find_parcel(scenario, "BOX028");
    const double half = 0.5 * model::collision_size(scenario, parcel).z();
    hanging = Pose{Matrix3::Identity(), robot.X_WE * Vector3(0.0, 0.0, scenario.cup.hold_length + half)};
    standing = cell::arrival_pose(scenario, scenario.sequences.front().items[1]);
  }
  ScriptedPlant plant;
  SessionOptions options;
  Pose hanging, standing;
};

TEST(Resume, ABoxThatHangsFromTheCupGoesToTheAlignerFirst) {
  TakenOver cell;
  EXPECT_EQ(cell.options.resume->to_do, std::vector{model::ItemIndex(1)});
  cell.plant.visible["BOX028"] = cell.hanging;
  cell.plant.happens = [&](int motion) {
    if (motion == 1) cell.plant.visible["BOX028"] = cell.standing;
    if (motion == 2) cell.plant.visible.erase("BOX028");  // as rehearsed
  };
  const SessionResult result = session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_GE(cell.plant.motions.size(), 2U);
  const plant::Motion& first = cell.plant.motions.front();
  EXPECT_EQ(first.item.value, "BOX028");
  EXPECT_TRUE(first.waypoints.front().io.vacuum);
  EXPECT_GE(first.waypoints.front().X_WE.p.z(), cell.plant.sensors().X_WE.p.z() - 1.0);
  const auto let_go = std::ranges::find_if(first.waypoints, [](const auto& one) { return !one.io.vacuum; });
  ASSERT_NE(let_go, first.waypoints.end());
  EXPECT_LT((let_go->X_WE.p - cell.standing.p).head<2>().norm(), 0.15) << "beside the aligner's corner";
  EXPECT_EQ(cell.plant.brought, std::vector<std::string>{"BOX028"});
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_TRUE(result.items[1].is_packed()) << result.items[1].reason;
}

/// The item that came first was let go and not counted, the next came meanwhile: it stands at the aligner.
TEST(Resume, ABoxThatHangsGoesElsewhereWhereTheAlignerIsTaken) {
  TakenOver cell;
  cell.options.resume = [] {
    EventLog log = killed_after<event::MotionStarted>(whole_log(), 1);
    log.events.push_back(event::ItemBrought{1.0, model::ItemIndex(1), true});
    return find_resume_point(log, "log");
  }();
  ASSERT_EQ(cell.options.resume->to_do.size(), 2U);
  cell.plant.visible["BOX027"] = cell.hanging;
  cell.plant.visible["BOX028"] = cell.standing;
  cell.plant.happens = [&](int motion) {
    if (motion == 1) cell.plant.visible.erase("BOX027");
  };
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  const plant::Motion& first = cell.plant.motions.front();
  EXPECT_EQ(first.item.value, "BOX027");
  const auto let_go = std::ranges::find_if(first.waypoints, [](const auto& one) { return !one.io.vacuum; });
  ASSERT_NE(let_go, first.waypoints.end());
  EXPECT_GT((let_go->X_WE.p - cell.standing.p).head<2>().norm(), 0.3) << "not onto the one that stands there";
}

TEST(Resume, ABoxThatHangsHighIsLiftedNoHigher) {
  TakenOver cell;
  const double tool = cell.plant.sensors().X_WE.p.z();
  cell.plant.visible["BOX028"] = cell.hanging;
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  EXPECT_LT(cell.plant.motions.front().waypoints.front().X_WE.p.z(), tool + 0.15) << "it is no obstacle to itself";
}

/// Held by its side: so the arm does not reach the aligner.
TEST(Resume, ABoxThatIsHeldByItsSideIsTurnedUnderTheTool) {
  TakenOver cell;
  plant::Feedback& robot = cell.plant.sensors();
  robot.X_WE.R = exp_rotation(-0.5 * std::numbers::pi * Vector3::UnitY()) * robot.X_WE.R;
  const double half = 0.5 * model::collision_size(two_boxes(), *model::find_parcel(two_boxes(), "BOX028")).x();
  cell.plant.visible["BOX028"] = {Matrix3::Identity(),
                                  robot.X_WE * Vector3(0.0, 0.0, two_boxes().cup.hold_length + half)};
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  const auto& waypoints = cell.plant.motions.front().waypoints;
  const auto let_go = std::ranges::find_if(waypoints, [](const auto& one) { return !one.io.vacuum; });
  ASSERT_NE(let_go, waypoints.end());
  EXPECT_LT(let_go->X_WE.R(2, 2), -0.99) << "the tool from above";
}

TEST(Resume, AStopOnTheWayOfWhatHangsIsReleasedAndAnotherWayTried) {
  TakenOver cell;
  const Pose X_EP = cell.plant.sensors().X_WE.inverse() * cell.hanging;
  const auto hangs = [&X_EP](TakenOver& one) { one.plant.visible["BOX028"] = one.plant.sensors().X_WE * X_EP; };
  hangs(cell);
  cell.plant.ends = {plant::EndReason::ProtectiveStop, plant::EndReason::Timeout};
  cell.plant.happens = [&](int motion) {
    hangs(cell);
    if (motion == 3) cell.plant.visible["BOX028"] = cell.standing;
    if (motion == 4) cell.plant.visible.erase("BOX028");
  };
  const SessionResult result = session::pack(two_boxes(), "1", cell.options, cell.plant);
  EXPECT_GE(cell.plant.acknowledged, 1);
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_TRUE(result.items[1].is_packed()) << result.items[1].reason;
  TakenOver stuck;
  hangs(stuck);
  stuck.plant.happens = [&](int) { hangs(stuck); };
  stuck.plant.ends.assign(100, plant::EndReason::ProtectiveStop);
  EXPECT_THROW((void)session::pack(two_boxes(), "1", stuck.options, stuck.plant), InputError) << "not for ever";
}

TEST(Resume, ABoxInTheCupThatNobodySeesIsRefusedBeforeAnythingMoves) {
  TakenOver cell;
  EXPECT_THROW((void)session::pack(two_boxes(), "1", cell.options, cell.plant), InputError);
  EXPECT_TRUE(cell.plant.motions.empty());
}

TEST(Resume, AToolThatHoldsNothingGoesStraightUpFirst) {
  TakenOver cell;
  cell.plant.sensors().io.vacuum = false;
  cell.plant.sensors().pressure_gauge = 0.0;
  const Pose before = cell.plant.sensors().X_WE;
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  const motion::Waypoint& up = cell.plant.motions.front().waypoints.back();
  EXPECT_EQ(up.X_WE.p.head<2>(), before.p.head<2>());
  EXPECT_GE(up.X_WE.p.z(), before.p.z());
  TakenOver at_home;
  at_home.plant.sensors() = ScriptedPlant().sensors();
  (void)session::pack(two_boxes(), "1", at_home.options, at_home.plant);
  EXPECT_NE(at_home.plant.motions.front().waypoints.back().variant, "_retreat") << "nothing to do";
}

TEST(Session, WhoIsInterruptedStaysWhereTheRobotWasStopped) {
  ScriptedPlant plant;
  plant.ends = {plant::EndReason::Cancelled};
  const SessionResult result = session::pack(two_boxes(), "1", quick_options(), plant);
  EXPECT_EQ(result.stop_reason, StopReason::Interrupted);
  EXPECT_EQ(plant.home_count, 0);
  EXPECT_FALSE(result.failure) << result.failure.text;
  ASSERT_EQ(result.items.size(), 1U);
  EXPECT_TRUE(has(result.items[0], Trouble::Cancelled, Remedy::Stop));
}

TEST(Resume, RefusesLogsThatNothingFollows) {
  EXPECT_THROW((void)find_resume_point({}, "log"), InputError);
  EXPECT_THROW((void)find_resume_point(whole_log(), "log"), InputError) << "it came to its end";
  EventLog headless = whole_log();
  headless.events.erase(headless.events.begin());
  EXPECT_THROW((void)find_resume_point(headless, "log"), InputError);
  EventLog planned = killed_after<event::Counted>(whole_log(), 1);
  std::get<event::SessionStarted>(planned.events.front()).places_are_chosen = true;
  EXPECT_THROW((void)find_resume_point(planned, "log"), InputError);
}

TEST(Resume, RefusesEventsThatAreNotOfOneSession) {
  const EventLog good = killed_after<event::Counted>(whole_log(), 1);
  EventLog twice = good;
  twice.events.push_back(good.events.front());
  EXPECT_THROW((void)find_resume_point(twice, "log"), InputError);
  EventLog ended = good;
  ended.events.push_back(event::ItemEnded{});
  EXPECT_THROW((void)find_resume_point(ended, "log"), InputError);
  for (const int item : {2, 1000, -7}) {
    EventLog stranger = good;
    stranger.events.push_back(event::ItemLost{model::ItemIndex(item), ItemEnd::Gone, {}});
    EXPECT_THROW((void)find_resume_point(stranger, "log"), InputError) << item;
    EventLog box = good;
    std::get<event::Counted>(box.events.back()).boxes.push_back({model::ItemIndex(item), {}, Vector3::Ones()});
    EXPECT_THROW((void)find_resume_point(box, "log"), InputError) << item;
  }
}

TEST(Resume, RefusesTheLogOfAnotherSession) {
  const ResumePoint point = find_resume_point(killed_after<event::Counted>(whole_log(), 1), "log");
  for (auto event::SessionStarted::*key :
       {&event::SessionStarted::sequence, &event::SessionStarted::agent, &event::SessionStarted::plant}) {
    SessionOptions options = quick_options();
    options.resume = point;
    std::get<event::SessionStarted>(options.resume->events.front()).*key = "another";
    ScriptedPlant plant;
    EXPECT_THROW((void)session::pack(two_boxes(), "1", options, plant), InputError);
    EXPECT_TRUE(plant.brought.empty());
  }
}

}  // namespace
}  // namespace snug::session
