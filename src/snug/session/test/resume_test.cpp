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
    X_EP = robot.X_WE.inverse() * hanging;
  }
  /// The box hangs where the tool is.
  void hang(const std::string& box) {
    const Pose& X_WE = plant.sensors().X_WE;
    plant.visible[box] = X_WE * X_EP;
  }
  /// The motion that puts down what hangs; before it the tool may go straight up.
  [[nodiscard]] const plant::Motion& put_down() const {
    static const plant::Motion none;
    const auto found = std::ranges::find_if(plant.motions, [](const plant::Motion& one) {
      return std::ranges::any_of(one.waypoints, [](const auto& waypoint) { return !waypoint.io.vacuum; });
    });
    return found != plant.motions.end() ? *found : none;
  }
  ScriptedPlant plant;
  SessionOptions options;
  Pose hanging, standing, X_EP;
};

Pose let_go_of(const plant::Motion& motion) {
  const auto let_go = std::ranges::find_if(motion.waypoints, [](const auto& one) { return !one.io.vacuum; });
  EXPECT_NE(let_go, motion.waypoints.end());
  return let_go != motion.waypoints.end() ? let_go->X_WE : Pose();
}

TEST(Resume, ABoxThatHangsFromTheCupGoesToTheAlignerFirst) {
  TakenOver cell;
  EXPECT_EQ(cell.options.resume->to_do, std::vector{model::ItemIndex(1)});
  cell.hang("BOX028");
  bool is_down = false;
  cell.plant.happens = [&](int) {
    if (is_down) cell.plant.visible.erase("BOX028");  // as rehearsed
    if (is_down) return;
    is_down = !cell.put_down().waypoints.empty();
    cell.hang("BOX028");
    if (is_down) cell.plant.visible["BOX028"] = cell.standing;
  };
  const SessionResult result = session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_GE(cell.plant.motions.size(), 2U);
  const plant::Motion& first = cell.put_down();
  EXPECT_EQ(first.item.value, "BOX028");
  EXPECT_TRUE(first.waypoints.front().io.vacuum);
  EXPECT_GE(first.waypoints.front().X_WE.p.z(), cell.plant.sensors().X_WE.p.z() - 1.0);
  EXPECT_LT((let_go_of(first).p - cell.standing.p).head<2>().norm(), 0.15) << "beside the aligner's corner";
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
  cell.hang("BOX027");
  cell.plant.visible["BOX028"] = cell.standing;
  cell.plant.happens = [&](int) {
    cell.hang("BOX027");
    if (!cell.put_down().waypoints.empty()) cell.plant.visible.erase("BOX027");
  };
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  EXPECT_EQ(cell.put_down().item.value, "BOX027");
  EXPECT_GT((let_go_of(cell.put_down()).p - cell.standing.p).head<2>().norm(), 0.3) << "not onto what stands there";
}

TEST(Resume, ABoxThatHangsHighIsLiftedNoHigher) {
  TakenOver cell;
  const double tool = cell.plant.sensors().X_WE.p.z();
  cell.hang("BOX028");
  cell.plant.happens = [&](int) { cell.hang("BOX028"); };
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  EXPECT_LT(cell.plant.motions.front().waypoints.front().X_WE.p.z(), tool + 0.15) << "it is no obstacle to itself";
}

/// Held by its side: so the arm does not reach the aligner. And low: it is looked at again when it is up.
TEST(Resume, ABoxThatIsHeldByItsSideIsTurnedUnderTheTool) {
  TakenOver cell;
  plant::Feedback& robot = cell.plant.sensors();
  robot.X_WE.R = exp_rotation(-0.5 * std::numbers::pi * Vector3::UnitY()) * robot.X_WE.R;
  robot.X_WE.p.z() -= 0.3;
  const double half = 0.5 * model::collision_size(two_boxes(), *model::find_parcel(two_boxes(), "BOX028")).x();
  const Pose beside{Matrix3::Identity(), robot.X_WE * Vector3(0.0, 0.0, two_boxes().cup.hold_length + half)};
  cell.X_EP = robot.X_WE.inverse() * beside;
  cell.hang("BOX028");
  cell.plant.happens = [&](int) { cell.hang("BOX028"); };
  (void)session::pack(two_boxes(), "1", cell.options, cell.plant);
  ASSERT_FALSE(cell.plant.motions.empty());
  EXPECT_EQ(cell.plant.motions.front().waypoints.size(), 1U) << "straight up";
  EXPECT_LT(let_go_of(cell.put_down()).R(2, 2), -0.99) << "the tool from above";
}

TEST(Resume, AStopOnTheWayOfWhatHangsIsReleasedAndAnotherWayTried) {
  TakenOver cell;
  cell.hang("BOX028");
  cell.plant.ends = {plant::EndReason::ProtectiveStop, plant::EndReason::Timeout};
  bool is_down = false;
  cell.plant.happens = [&](int motion) {
    if (is_down) cell.plant.visible.erase("BOX028");
    if (is_down) return;
    is_down = motion > 2 && cell.plant.motions.back().waypoints.size() > 1;
    cell.hang("BOX028");
    if (is_down) cell.plant.visible["BOX028"] = cell.standing;
  };
  const SessionResult result = session::pack(two_boxes(), "1", cell.options, cell.plant);
  EXPECT_GE(cell.plant.acknowledged, 1);
  ASSERT_EQ(result.items.size(), 2U);
  EXPECT_TRUE(result.items[1].is_packed()) << result.items[1].reason;
  TakenOver stuck;
  stuck.hang("BOX028");
  stuck.plant.happens = [&](int) { stuck.hang("BOX028"); };
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
