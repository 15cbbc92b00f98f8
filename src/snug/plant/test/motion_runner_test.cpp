// MotionRunner: when guards and patience end a motion, when a tool that has arrived is done, and what is said of it.
#include "snug/plant/motion_runner.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "snug/core/rng.hpp"

namespace snug::plant {
namespace {

constexpr double kNeeded = -2.0e4;  ///< Pa

RunnerSettings settings(bool is_lagged = false) { return {settings::MotionGuards{}, kNeeded, is_lagged}; }

motion::WaypointIndex at_waypoint(int index) { return motion::WaypointIndex(index); }

/// Of so many waypoints.
Motion guarded(const Guards& guards, std::size_t waypoints = 1) {
  return {{}, std::vector<motion::Waypoint>(waypoints), guards, {}};
}

TickReading at(double time, double force, double pressure, bool is_vacuum_on) {
  return {time, {Vector3(0.0, 0.0, force), Vector3(0.1, 0.0, 0.0)}, pressure, is_vacuum_on};
}

/// Checked from 0 s every 8 ms until it ends, at most two minutes; the time of its end.
double time_of_end(MotionRunner& runner, const Guards& guards, const std::function<TickReading(double)>& read) {
  runner.begin(guarded(guards), read(0.0), false);
  for (int tick = 1; tick < 15'000; ++tick) {
    const double now = 0.008 * tick;
    runner.follow({at_waypoint(0), now});
    runner.check(read(now));
    if (runner.has_ended()) return now;
  }
  return std::numeric_limits<double>::infinity();
}

/// What it came to.
Feedback finished(MotionRunner& runner) {
  Feedback feedback;
  runner.finish(feedback);
  return feedback;
}

TEST(MotionRunner, EndsAtAForceAndKeepsItsPeak) {
  MotionRunner runner(settings());
  const double end = time_of_end(runner, {50.0, true}, [](double t) { return at(t, 20.0 * t, 0.0, false); });
  EXPECT_DOUBLE_EQ(end, 2.504) << "the first tick beyond 2.5 s";
  EXPECT_EQ(runner.end(), (End{EndReason::ForceGuard, at_waypoint(0), 20.0 * 2.504, 50.0, ""}));
  const Feedback fed = finished(runner);
  EXPECT_DOUBLE_EQ(fed.peak_force, 20.0 * 2.504);
  EXPECT_DOUBLE_EQ(fed.peak_torque, 0.1);
}

TEST(MotionRunner, ANewVacuumHasTimeAndALostOneHasNone) {
  MotionRunner none(settings());
  EXPECT_NEAR(time_of_end(none, {}, [](double t) { return at(t, 0.0, -1.0e4, t > 0.99); }), 1.45, 0.009);
  EXPECT_EQ(none.end().reason, EndReason::NoSeal);
  MotionRunner lost(settings());
  EXPECT_NEAR(time_of_end(lost, {}, [](double t) { return at(t, 0.0, t < 3.0 ? -6.0e4 : 0.0, true); }), 3.0, 0.009);
  EXPECT_EQ(lost.end().reason, EndReason::VacuumLost);
  MotionRunner off(settings());
  EXPECT_GT(time_of_end(off, {std::nullopt, false}, [](double t) { return at(t, 0.0, 0.0, true); }), 59.0);
  EXPECT_EQ(off.end().reason, EndReason::Timeout) << "nothing else is guarded";
}

TEST(MotionRunner, EndsWhereTheCupHoldsTooLittleMoreThanItHasTo) {
  const auto falling = [](bool is_vacuum_on) {
    return [is_vacuum_on](double t) {
      TickReading now = at(t, 0.0, -6.0e4, is_vacuum_on);
      now.hold_factor = 10.0 / t;
      return now;
    };
  };
  MotionRunner tripped(settings());
  EXPECT_DOUBLE_EQ(time_of_end(tripped, {.force = {}, .hold_factor = 2.5}, falling(true)), 4.008)
      << "the first tick beyond 4 s";
  EXPECT_EQ(tripped.end().reason, EndReason::HoldGuard);
  EXPECT_DOUBLE_EQ(tripped.end().value, 10.0 / 4.008);
  EXPECT_EQ(tripped.end().limit, 2.5);
  EXPECT_EQ(describe(tripped.end(), {}), "hold guard: the cup could hold 2.5 times its load, 2.5 times are needed");
  MotionRunner unguarded(settings()), let_go(settings()), nothing(settings());
  EXPECT_GT(time_of_end(unguarded, {}, falling(true)), 59.0);
  EXPECT_GT(time_of_end(let_go, {.force = {}, .hold_factor = 2.5}, falling(false)), 59.0)
      << "nothing is held with the vacuum off";
  EXPECT_GT(time_of_end(nothing, {.force = {}, .hold_factor = 2.5}, [](double t) { return at(t, 0.0, -6.0e4, true); }),
            59.0)
      << "a plant that cannot tell: infinity";
}

TEST(MotionRunner, AHeldBoxAtTheStartIsLostAtOnce) {
  MotionRunner runner(settings());
  runner.begin(guarded({}), at(5.0, 0.0, -6.0e4, true), true);
  runner.follow({at_waypoint(0), 5.008});
  runner.check(at(5.008, 0.0, 0.0, true));
  EXPECT_EQ(runner.end().reason, EndReason::VacuumLost);
}

TEST(MotionRunner, ANewWaypointHasPatienceOfItsOwn) {
  MotionRunner runner(settings());
  runner.begin(guarded({}, 3), at(0.0, 0.0, 0.0, false), false);
  runner.follow({at_waypoint(0), 0.008});
  runner.follow({at_waypoint(1), 50.0});
  runner.check(at(100.0, 0.0, 0.0, false));
  EXPECT_FALSE(runner.has_ended());
  runner.check(at(110.1, 0.0, 0.0, false));
  EXPECT_EQ(runner.end().reason, EndReason::Timeout);
}

MotionRunner arrived_at(double time, const RunnerSettings& with, std::optional<motion::WaypointIndex> perceive_after) {
  MotionRunner runner(with);
  Motion motion = guarded({}, 2);
  motion.perceive_after = perceive_after;
  runner.begin(motion, at(0.0, 0.0, 0.0, false), false);
  runner.follow({at_waypoint(1), time});
  runner.arrive(time);
  return runner;
}

TEST(MotionRunner, SettlesUntilTheToolStandsButNotBeforeAndNotForEver) {
  const MotionRunner lagged = arrived_at(10.0, settings(true), {}), exact = arrived_at(10.0, settings(), {});
  EXPECT_FALSE(lagged.is_settled(10.2, 0.0));
  EXPECT_TRUE(lagged.is_settled(10.31, 0.0));
  EXPECT_FALSE(exact.is_settled(10.09, 0.0));
  EXPECT_TRUE(exact.is_settled(10.11, 0.0));
  EXPECT_FALSE(lagged.is_settled(11.9, 0.1));
  EXPECT_TRUE(lagged.is_settled(12.0, 0.1));
  const MotionRunner seen = arrived_at(10.0, settings(), at_waypoint(0));
  EXPECT_TRUE(seen.is_settled(10.01, 0.0)) << "the boxes were perceived";
  EXPECT_FALSE(arrived_at(10.0, settings(), at_waypoint(1)).is_settled(10.01, 0.0)) << "the last is not passed";
  EXPECT_FALSE(arrived_at(10.0, settings(true), at_waypoint(0)).is_settled(10.2, 0.0)) << "the tool still comes in";
}

TEST(MotionRunner, SumsWhatEachWaypointTook) {
  MotionRunner runner(settings());
  runner.begin(guarded({}, 2), at(2.0, 0.0, 0.0, false), false);
  runner.follow({at_waypoint(0), 2.5});
  runner.follow({at_waypoint(1), 2.75, true});
  runner.follow({at_waypoint(1), 3.0, true});
  runner.follow({at_waypoint(1), 4.0});
  runner.rest(4.5);
  const Feedback fed = finished(runner);
  ASSERT_EQ(fed.times.size(), 2u);
  EXPECT_EQ(fed.times[0], (WaypointTime{0.5, 0.0}));
  EXPECT_EQ(fed.times[1], (WaypointTime{1.0, 1.0}));
}

TEST(MotionRunner, SaysWhenTheVacuumComesAndGoesAndComesAgain) {
  MotionRunner runner(settings());
  runner.begin(guarded({std::nullopt, false}), at(0.0, 0.0, 0.0, true), false);
  std::string story;
  for (const double pressure : {0.0, -1.0e4, -3.0e4, -6.0e4, -1.0e4, 0.0, -3.0e4, -3.0e4}) {
    runner.check(at(1.0, 0.0, pressure, true));
    for (const Event& event : runner.take_events()) {
      story += get<VacuumBuilt>(event) != nullptr ? "b" : get<VacuumDropped>(event) != nullptr ? "d" : "?";
    }
  }
  EXPECT_EQ(story, "bdb");
  runner.check(at(2.0, 0.0, 0.0, false));
  EXPECT_FALSE(runner.has_events()) << "it was switched off";
}

TEST(MotionRunner, AWaypointThatIsJumpedOverIsPassedToo) {
  MotionRunner runner(settings());
  runner.begin(guarded({}, 5), at(0.0, 0.0, 0.0, false), false);
  runner.follow({at_waypoint(3), 1.0});
  runner.check(at(1.0, 0.0, 0.0, false));
  const std::vector<Event> events = runner.take_events();
  ASSERT_EQ(events.size(), 3U);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(events[static_cast<std::size_t>(i)], (Event{1.0, WaypointPassed{at_waypoint(i)}}));
}

/// A thousand motions with random readings: one end each, passed waypoints in order, the times add up.
TEST(MotionRunner, WhateverItReadsEachMotionEndsOnceAndItsTimesAddUp) {
  Rng rng = Rng(5).split("motions");
  MotionRunner runner(settings());
  double now = 0.0;
  for (int k = 0; k < 1000; ++k) {
    SCOPED_TRACE(k);
    const int waypoints = 1 + rng.index(5);
    Guards guards;
    if (rng.index(2) == 0) guards.force = rng.uniform(0.0, 100.0);
    guards.vacuum = rng.index(2) == 0;
    const double start = now;
    runner.begin(guarded(guards, static_cast<std::size_t>(waypoints)), at(now, 0.0, 0.0, false), rng.index(2) == 0);
    int aim = 0;
    while (!runner.has_ended() && aim < waypoints) {
      now += 0.008;
      runner.follow({at_waypoint(aim), now, rng.index(4) == 0});
      runner.check(at(now, rng.uniform(0.0, 60.0), rng.uniform(-6.0e4, 0.0), rng.index(3) == 0));
      if (rng.index(200) == 0) runner.stop(EndReason::Cancelled);
      aim += rng.index(10) == 0 ? 1 : 0;
    }
    if (!runner.has_ended()) {
      runner.arrive(now);
      while (!runner.is_settled(now, 0.0)) now += 0.008;
      runner.rest(now);
    }
    Feedback feedback;
    feedback.time = now;
    runner.finish(feedback);
    double sum = 0.0;
    for (const WaypointTime& one : feedback.times) sum += one.moving + one.waiting;
    EXPECT_NEAR(sum, now - start, 1e-9);
    int passed = 0, ends = 0;
    for (const Event& event : runner.take_events()) {
      EXPECT_EQ(ends, 0) << "nothing follows the end";
      if (const auto* one = get<WaypointPassed>(event)) {
        EXPECT_EQ(one->waypoint.value, passed++);
      }
      ends += get<MotionEnded>(event) != nullptr ? 1 : 0;
    }
    EXPECT_EQ(ends, 1);
    EXPECT_FALSE(runner.is_moving());
  }
}

TEST(MotionRunnerDeathTest, OneMotionAtATime) {
  MotionRunner runner(settings());
  runner.begin(guarded({}), at(0.0, 0.0, 0.0, false), false);
  EXPECT_DEATH(runner.begin(guarded({}), at(0.0, 0.0, 0.0, false), false), "a motion is under way");
}

}  // namespace
}  // namespace snug::plant
