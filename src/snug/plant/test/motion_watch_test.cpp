// MotionWatch: when guards and patience end a motion, and when a tool that has arrived is done.
#include "snug/plant/motion_watch.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace snug::plant {
namespace {

constexpr double kNeeded = -2.0e4;  ///< Pa

TickReading at(double time, double force, double pressure, bool is_vacuum_on) {
  return {time, {Vector3(0.0, 0.0, force), Vector3(0.1, 0.0, 0.0)}, pressure, is_vacuum_on};
}

/// Checked from 0 s every 8 ms until it ends, at most two minutes; the time of its end.
double time_of_end(MotionWatch& watch, const Guards& guards, const std::function<TickReading(double)>& read) {
  watch.begin(read(0.0), false);
  for (int tick = 1; tick < 15'000; ++tick) {
    const double now = 0.008 * tick;
    watch.follow(0, now);
    watch.check(guards, kNeeded, read(now));
    if (watch.end.reason != EndReason::Completed) return now;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(MotionWatch, EndsAtAForceAndKeepsItsPeak) {
  MotionWatch watch;
  const double end = time_of_end(watch, {50.0, true}, [](double t) { return at(t, 20.0 * t, 0.0, false); });
  EXPECT_DOUBLE_EQ(end, 2.504) << "the first tick beyond 2.5 s";
  EXPECT_EQ(watch.end, (End{EndReason::ForceGuard, 0, 20.0 * 2.504, 50.0, ""}));
  EXPECT_DOUBLE_EQ(watch.peak_force, 20.0 * 2.504);
  EXPECT_DOUBLE_EQ(watch.peak_torque, 0.1);
}

TEST(MotionWatch, ANewVacuumHasTimeAndALostOneHasNone) {
  MotionWatch none;
  EXPECT_NEAR(time_of_end(none, {}, [](double t) { return at(t, 0.0, -1.0e4, t > 0.99); }), 1.45, 0.009);
  EXPECT_EQ(none.end.reason, EndReason::NoSeal);
  MotionWatch lost;
  EXPECT_NEAR(time_of_end(lost, {}, [](double t) { return at(t, 0.0, t < 3.0 ? -6.0e4 : 0.0, true); }), 3.0, 0.009);
  EXPECT_EQ(lost.end.reason, EndReason::VacuumLost);
  MotionWatch off;
  EXPECT_GT(time_of_end(off, {std::nullopt, false}, [](double t) { return at(t, 0.0, 0.0, true); }), 59.0);
  EXPECT_EQ(off.end.reason, EndReason::Timeout) << "nothing else is guarded";
}

TEST(MotionWatch, EndsWhereTheCupHoldsTooLittleMoreThanItHasTo) {
  const auto falling = [](bool is_vacuum_on) {
    return [is_vacuum_on](double t) {
      TickReading now = at(t, 0.0, -6.0e4, is_vacuum_on);
      now.hold_factor = 10.0 / t;
      return now;
    };
  };
  MotionWatch guarded;
  EXPECT_DOUBLE_EQ(time_of_end(guarded, {.force = {}, .hold_factor = 2.5}, falling(true)), 4.008)
      << "the first tick beyond 4 s";
  EXPECT_EQ(guarded.end.reason, EndReason::HoldGuard);
  EXPECT_DOUBLE_EQ(guarded.end.value, 10.0 / 4.008);
  EXPECT_EQ(guarded.end.limit, 2.5);
  EXPECT_EQ(describe(guarded.end, {}), "hold guard: the cup could hold 2.5 times its load, 2.5 times are needed");
  MotionWatch unguarded, let_go;
  EXPECT_GT(time_of_end(unguarded, {}, falling(true)), 59.0);
  EXPECT_GT(time_of_end(let_go, {.force = {}, .hold_factor = 2.5}, falling(false)), 59.0)
      << "nothing is held with the vacuum off";
  MotionWatch nothing;  // a plant that cannot tell: infinity
  EXPECT_GT(time_of_end(nothing, {.force = {}, .hold_factor = 2.5}, [](double t) { return at(t, 0.0, -6.0e4, true); }),
            59.0);
}

TEST(MotionWatch, AHeldBoxAtTheStartIsLostAtOnce) {
  MotionWatch watch;
  watch.begin(at(5.0, 0.0, -6.0e4, true), true);
  watch.check({}, kNeeded, at(5.008, 0.0, 0.0, true));
  EXPECT_EQ(watch.end.reason, EndReason::VacuumLost);
}

TEST(MotionWatch, ANewRowHasPatienceOfItsOwn) {
  MotionWatch watch;
  watch.begin(at(0.0, 0.0, 0.0, false), false);
  watch.follow(0, 0.008);
  watch.follow(1, 50.0);
  watch.check({}, kNeeded, at(100.0, 0.0, 0.0, false));
  EXPECT_EQ(watch.end.reason, EndReason::Completed);
  watch.check({}, kNeeded, at(110.1, 0.0, 0.0, false));
  EXPECT_EQ(watch.end.reason, EndReason::Timeout);
}

TEST(Settling, EndsWhenTheToolStandsButNotBeforeAndNotNever) {
  const settings::MotionGuards settings;
  const double lagged = least_settle(settings, true, false), exact = least_settle(settings, false, false);
  EXPECT_TRUE(is_settling(settings, lagged, 10.0, 10.2, 0.0));
  EXPECT_FALSE(is_settling(settings, lagged, 10.0, 10.31, 0.0));
  EXPECT_TRUE(is_settling(settings, exact, 10.0, 10.09, 0.0));
  EXPECT_FALSE(is_settling(settings, exact, 10.0, 10.11, 0.0));
  EXPECT_TRUE(is_settling(settings, lagged, 10.0, 11.9, 0.1));
  EXPECT_FALSE(is_settling(settings, lagged, 10.0, 12.0, 0.1));
  EXPECT_FALSE(is_settling(settings, least_settle(settings, false, true), 10.0, 10.01, 0.0)) << "they were looked at";
  EXPECT_EQ(least_settle(settings, true, true), lagged) << "the tool still comes in";
}

TEST(MotionWatch, SumsWhatEachWaypointTook) {
  MotionWatch watch;
  watch.begin({2.0, {}, 0.0, false}, false);
  watch.follow(0, 2.5);
  watch.follow(1, 2.75, true);
  watch.follow(1, 3.0, true);
  watch.follow(1, 4.0);
  watch.rest(4.5);
  ASSERT_EQ(watch.times.size(), 2u);
  EXPECT_EQ(watch.times[0], (WaypointTime{0.5, 0.0}));
  EXPECT_EQ(watch.times[1], (WaypointTime{1.0, 1.0}));
}

}  // namespace
}  // namespace snug::plant
