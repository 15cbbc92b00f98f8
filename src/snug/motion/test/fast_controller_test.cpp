// Tests of the fast controller: blends, rows and waits that end by what is felt, and by time where nothing is felt.
#include "snug/motion/fast_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/test/allocation_count.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

constexpr IO kHold{.vacuum = true};

Waypoint row(const char* name, const Vector3& p, const IO& io = {}) {
  return named_waypoint(name, {Matrix3::Identity(), p}, io);
}

ControllerSettings fast_settings(double tempo = 1.0) {
  ControllerSettings settings;
  settings.tracking = FastTracking{tempo};
  settings.limits = {{"", MotionLimits{}}, {"PlaceSlow", {0.002, 1.0, 0.15, 0.6, 1.0}}, {"TwistDrag", {0.2}}};
  settings.fast.sealed_pressure = -4.0e4;
  settings.fast.released_pressure = -1.0e3;
  return settings;
}

struct Course {
  std::vector<ControllerOutput> ticks;
  [[nodiscard]] double arrival(int reached) const {
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      if (ticks[i].reached == reached) return 0.008 * static_cast<double>(i);
    }
    return std::numeric_limits<double>::infinity();
  }
};

/// `feel`: what is sensed at the end of a tick.
Course run(const PreparedProgram& plan, const std::function<Sensed(const ControllerState&)>& feel = {}) {
  Course course;
  ControllerState state = make_controller_state(Pose{});
  ToolState measured = state.command;
  while (course.ticks.size() < 20000) {
    course.ticks.push_back(tick(plan, measured, state));
    measured = course.ticks.back().tool;
    if (feel) state.sensed = feel(state);
    if (course.ticks.back().finished_now) break;
  }
  return course;
}

const std::vector<Waypoint> kCorner = {row("PrePick(A)", {0.5, 0.0, 0.0}), row("PostPlace(A)", {0.5, 0.4, 0.0})};

TEST(FastController, BlendsWhatTouchesNothingAndStaysNearTheCorner) {
  const Course course = run(prepare({"corner", kCorner}, fast_settings()));
  double slowest = 1.0, nearest = 1.0;
  Vector3 before = Vector3::Zero();
  for (const ControllerOutput& out : course.ticks) {
    const double speed = out.tool.V_WE.linear.norm();
    const Vector3& p = out.tool.X_WE.p;
    nearest = std::min(nearest, (p - kCorner[0].X_WE.p).norm());
    const bool is_at_corner = (p - kCorner[0].X_WE.p).norm() < 0.03;
    if (is_at_corner) slowest = std::min(slowest, speed);
    const double both = 2.0 * FastSettings{}.empty.max_acceleration;
    EXPECT_LE((out.tool.V_WE.linear - before).norm(), 0.008 * both) << "at most both accelerations";
    before = out.tool.V_WE.linear;
  }
  EXPECT_GT(slowest, 0.05) << "m/s: it does not stop";
  EXPECT_LT(nearest, 0.05);
  EXPECT_EQ(course.ticks.back().tool.X_WE, kCorner[1].X_WE);
  std::vector<Waypoint> stops = kCorner;
  stops[1].io.conveyor_cw = true;  // something is switched: it stops there
  EXPECT_LT(course.arrival(1), run(prepare({"stops", stops}, fast_settings())).arrival(1) - 0.1);
}

TEST(FastController, GoesAwayBeforeItsWayUpEnds) {
  const std::vector<Waypoint> rows = {row("PrePick(A)", {0.1, 0.0, 0.0}), row("PostPlace(A)", {0.1, 0.0, 0.2}),
                                      row("PostPlace(A)_away", {0.1, 0.6, 0.2})};
  const Course course = run(prepare({"away", rows}, fast_settings()));
  double height = 0.0, distance = 0.0;
  for (const ControllerOutput& out : course.ticks) {
    if (height == 0.0 && out.tool.X_WE.p.y() > 1e-6) height = out.tool.X_WE.p.z();
    if (out.tool.X_WE.p.z() < 0.19) distance = std::max(distance, out.tool.X_WE.p.y());
  }
  EXPECT_GT(height, 0.2 - 0.08 - 1e-9);
  EXPECT_LT(height, 0.16);
  EXPECT_LT(distance, 0.03) << "it goes away slowly at first";
  EXPECT_EQ(course.ticks.back().tool.X_WE, rows.back().X_WE);
}

TEST(FastController, DoesNotStopWhereItIsAlready) {
  const auto arrival = [](double off) {
    return run(prepare({"there", {row("PrePick(A)", {off, 0.0, 0.0}), row("Box(A)", {0.0, 0.0, -0.1})}},
                       fast_settings()))
        .arrival(0);
  };
  EXPECT_LE(arrival(1e-5), 0.008 + 1e-9);
  EXPECT_GT(arrival(0.01), 0.05);
}

TEST(FastController, StandsUntilTheNextRowMayBegin) {
  for (const double instant : {1.0, 2.004, 5.0}) {  // the tool is there at 1.3 s
    std::vector<Waypoint> waits = kCorner, stops = kCorner;
    waits[1].not_before = instant;
    waits[1].io.blow_off = true;  // switched then, not before
    stops.pop_back();
    const Course course = run(prepare({"waits", waits}, fast_settings()));
    const Course alone = run(prepare({"stops", stops}, fast_settings()));
    const double there = alone.arrival(0);
    EXPECT_EQ(course.arrival(0), there) << "no blend: a motion that is sent ends at rest";
    double departed = 0.0;
    for (std::size_t i = 0; i < course.ticks.size(); ++i) {
      const ControllerOutput& out = course.ticks[i];
      if (i < alone.ticks.size()) {
        EXPECT_EQ(out.tool, alone.ticks[i].tool) << "until there as if it were all";
      }
      if (out.departed == 1) departed = 0.008 * static_cast<double>(i);
      EXPECT_EQ(out.io.blow_off, departed > 0.0);
      if (departed > 0.0 || i < alone.ticks.size() - 1) continue;
      EXPECT_EQ(out.phase, ControllerPhase::Standing);
      EXPECT_EQ(out.tool, (ToolState{kCorner[0].X_WE, {}}));
    }
    EXPECT_NEAR(departed, std::max(there, instant), 0.004 + 1e-9) << "the nearest tick, or when it is there";
    EXPECT_TRUE(course.ticks.back().finished_now);
  }
}

TEST(FastController, TempoStretchesMotionsButNotTheirWindow) {
  const std::vector<Waypoint> one = {row("PrePick(A)", {1.0, 0.0, 0.0})};
  const double window = FastSettings{}.empty.window;
  const double whole = run(prepare({"one", one}, fast_settings(1.0))).arrival(0) - window;
  const double half = run(prepare({"one", one}, fast_settings(0.5))).arrival(0) - window;
  EXPECT_NEAR(half, 2.0 * whole, 0.02) << "two ticks";
}

TEST(FastController, WaitsUntilThePressureSaysSoOrTheTimeIsOver) {
  const std::vector<Waypoint> pick = {row("Box(A)", {0.0, 0.0, -0.1}), row("PostPick(A)", {0.0, 0.0, 0.1}, kHold),
                                      row("Place(A)", {0.0, 0.0, 0.1}, {.blow_off = true})};
  const PreparedProgram plan = prepare({"pick", pick}, fast_settings());
  const auto waited = [&](const Course& course, int row) {
    int ticks = 0;
    for (const ControllerOutput& out : course.ticks) {
      ticks += out.row == row && out.phase == ControllerPhase::Waiting ? 1 : 0;
    }
    return 0.008 * ticks;
  };
  double pressure = 0.0;
  const Course sealed = run(plan, [&](const ControllerState& state) {
    const double wanted = state.io.vacuum ? -6.0e4 : 0.0;
    pressure += 0.05 * (wanted - pressure);
    return Sensed{pressure, Vector3::Zero()};
  });
  // -60 kPa (1 - 0.95^n) <= -40 kPa from n = 22 on; back to -1 kPa takes n = 80 ticks: longer than 0.5 s.
  EXPECT_NEAR(waited(sealed, 1), 22 * 0.008, 1.1 * 0.008);
  EXPECT_NEAR(waited(sealed, 2), 0.5, 1.1 * 0.008);
  EXPECT_NEAR(waited(run(plan), 1), 0.5, 1.1 * 0.008) << "nothing is felt";
}

TEST(FastController, LeavesABoxSlowlyUntilItStopsBlowingAndThenWithoutAStop) {
  constexpr IO kBlow{.blow_off = true};
  const std::vector<Waypoint> release = {
      row("Place(A)", {0.0, 0.0, 0.0}, kHold), row("Place(A)", {0.0, 0.0, 0.0}, kBlow),
      row("PostPlace(A)_off", {0.0, 0.0, 0.025}, kBlow), row("PostPlace(A)", {0.0, 0.0, 0.4})};
  const PreparedProgram plan = prepare({"release", release}, fast_settings());
  const Course course = run(plan);
  double fastest_blowing = 0.0, fastest = 0.0, slowest_between = 1.0;
  for (const ControllerOutput& out : course.ticks) {
    const double z = out.tool.X_WE.p.z(), speed = out.tool.V_WE.linear.z();
    (out.io.blow_off ? fastest_blowing : fastest) = std::max(out.io.blow_off ? fastest_blowing : fastest, speed);
    if (z > 0.012 && z < 0.2) slowest_between = std::min(slowest_between, speed);
    EXPECT_TRUE(!out.io.blow_off || z <= 0.025) << z;
  }
  EXPECT_LE(fastest_blowing, plan.settings.fast.detach.max_speed + 1e-9);
  EXPECT_GT(fastest, 2.0 * plan.settings.fast.detach.max_speed);
  EXPECT_GT(slowest_between, 0.05) << "the retreat begins on the way";
}

/// Amplitude that an undamped swing of this period has in the end, which the tool's vertical acceleration drives, m.
double swing_after(const Course& course, double period) {
  const double frequency = 2.0 * std::numbers::pi / period;
  std::complex<double> sum = 0.0;
  double before = 0.0;
  for (std::size_t i = 0; i < course.ticks.size(); ++i) {
    const double speed = course.ticks[i].tool.V_WE.linear.z();
    sum += (speed - before) * std::polar(1.0, -frequency * 0.008 * static_cast<double>(i));
    before = speed;
  }
  return std::abs(sum) / frequency;
}

TEST(FastController, ABoxThatIsSentStraightDownDoesNotSwing) {
  ControllerSettings settings = fast_settings();
  settings.fast.insert.max_acceleration = 6.0;
  const auto sent = [&](const char* name) {
    return run(prepare({"place", {row(name, {0.0, 0.0, -0.3}, kHold)}}, settings));
  };
  const Course shaped = sent("Place(A)_down~0.42+0.30"), plain = sent("Place(A)_down");
  EXPECT_GT(swing_after(plain, 0.42), 0.01);
  EXPECT_LT(swing_after(shaped, 0.42), 0.02 * swing_after(plain, 0.42));
  const double saved = 0.25 * settings.fast.insert.max_speed / settings.fast.insert.max_acceleration;
  EXPECT_NEAR(shaped.arrival(0) - plain.arrival(0), 0.21 - saved, 1.1 * 0.008)
      << "half of it comes half a period later, and speeds up at twice the acceleration";
  const Course aside = run(prepare({"place", {row("Place(A)~0.42+0.30", {0.1, 0.0, -0.3}, kHold)}}, fast_settings()));
  const Course told_nothing = run(prepare({"place", {row("Place(A)", {0.1, 0.0, -0.3}, kHold)}}, fast_settings()));
  EXPECT_EQ(aside.arrival(0), told_nothing.arrival(0)) << "pushed, it leans on something";
}

TEST(FastController, ABoxThatIsLiftedByItsSideLeavesTheBenchSlowly) {
  const auto fastest = [](const char* name, const Matrix3& R_WE) {
    const std::vector<Waypoint> lift = {named_waypoint("PreRePick(A)", {R_WE, Vector3::Zero()}),
                                        named_waypoint(name, {R_WE, Vector3(0.0, 0.0, 0.4)}, kHold)};
    double most = 0.0;
    for (const ControllerOutput& out : run(prepare({"lift", lift}, fast_settings())).ticks) {
      most = std::max(most, out.tool.V_WE.linear.z());
    }
    return most;
  };
  const Matrix3 level = exp_rotation(Vector3(0.0, 0.5 * std::numbers::pi, 0.0));
  // A swing of period T that begins at its middle with speed v has the amplitude v T / (2 pi).
  const double swings = FastSettings{}.lift_swing;
  EXPECT_NEAR(fastest("PostRePick(A)~0.42+0.30", level) * 0.42 / (2.0 * std::numbers::pi), swings, 1e-6);
  EXPECT_NEAR(fastest("PostRePick(A)~0.21+0.20", level) * 0.21 / (2.0 * std::numbers::pi), swings, 1e-6);
  const Matrix3 upright = exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0));
  EXPECT_GT(fastest("PostRePick(A)~0.42+0.30", upright), 0.8) << "hanging under the cup it does not tilt";
}

/// A support 4 mm above where the box is sent, felt as a spring.
Sensed on_support(const ControllerState& state) {
  const double depth = std::max(0.0, -0.196 - state.command.X_WE.p.z());
  return {-6.0e4, Vector3(0.0, 0.0, -5.0 + 2.0e4 * depth)};
}

TEST(FastController, APlaceEndsWhereTheBoxStands) {
  const std::vector<Waypoint> place = {row("PrePlace(A)", {0.0, 0.0, 0.05}, kHold),
                                       row("Place(A)", {0.0, 0.0, -0.2}, kHold),
                                       row("Place(A)", {0.0, 0.0, -0.2}, {.blow_off = true})};
  const PreparedProgram plan = prepare({"place", place}, fast_settings());
  double deepest = 0.0;
  for (const ControllerOutput& out : run(plan, on_support).ticks) {
    if (out.row <= 1) deepest = std::min(deepest, out.tool.X_WE.p.z());
  }
  const double force = plan.settings.fast.press_force;
  EXPECT_LT(deepest, -0.196 - force / 2.0e4);
  EXPECT_GT(deepest, -0.2) << "not as deep as it was sent";
  double blind = 0.0;
  for (const ControllerOutput& out : run(plan).ticks) {
    if (out.row <= 1) blind = std::min(blind, out.tool.X_WE.p.z());
  }
  EXPECT_EQ(blind, -0.2) << "where nothing is felt, the place counts";
}

TEST(FastController, WhatIsFeltTooEarlyIsNotTheSupport) {
  const std::vector<Waypoint> place = {row("PrePlace(A)", {0.0, 0.0, 0.05}, kHold),
                                       row("Place(A)", {0.0, 0.0, -0.2}, kHold)};
  double deepest = 0.0;
  const Course course = run(prepare({"place", place}, fast_settings()), [](const ControllerState& state) {
    const double z = state.command.X_WE.p.z();
    return Sensed{-6.0e4, Vector3(0.0, 0.0, z < -0.1 && z > -0.15 ? 60.0 : 0.0)};  // an edge on the way
  });
  for (const ControllerOutput& out : course.ticks) deepest = std::min(deepest, out.tool.X_WE.p.z());
  EXPECT_EQ(deepest, -0.2);
}

TEST(FastController, ABoxIsLetGoOnTheWayOfADrag) {
  const std::vector<Waypoint> drag = {
      row("Twist(A)", {0.0, 0.0, 0.1}, kHold), row("TwistDrag(A)", {0.32, 0.0, 0.1}, kHold),
      row("TwistDrag(A)", {0.32, 0.0, 0.1}, {.blow_off = true}), row("PreTwist(A)_back", {0.32, 0.0, 0.3})};
  const Course course = run(prepare({"drag", drag}, fast_settings()));
  const std::size_t release = static_cast<std::size_t>(std::llround(course.arrival(1) / 0.008));
  EXPECT_TRUE(course.ticks[release].io.blow_off);
  EXPECT_NEAR(course.ticks[release].tool.X_WE.p.x(), 0.12, 0.01);
  EXPECT_GT(course.ticks[release].tool.V_WE.linear.x(), 0.2) << "m/s";
  EXPECT_EQ(course.ticks.back().tool.X_WE, drag.back().X_WE);
}

TEST(FastController, ARowIsNotReachedWhileTheToolIsBehind) {
  const PreparedProgram plan = prepare({"late", {row("PrePick(A)", {0.3, 0.0, 0.0})}}, fast_settings());
  ControllerState state = make_controller_state(Pose{});
  const ToolState stuck{Pose{}, {}};
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(tick(plan, stuck, state).finished_now);
  EXPECT_TRUE(tick(plan, state.command, state).finished_now);
}

TEST(FastController, NeitherAllocatesNorDependsOnWhereItIsTakenUp) {
  const PreparedProgram plan = prepare({"corner", kCorner}, fast_settings());
  ControllerState state = make_controller_state(Pose{});
  ToolState measured = state.command;
  const long before = snug::test::allocation_count();
  for (int i = 0; i < 60; ++i) measured = tick(plan, measured, state).tool;
  EXPECT_EQ(snug::test::allocation_count(), before);
  ControllerState copy = state;
  ToolState other = measured;
  for (int i = 0; i < 200; ++i) {
    measured = tick(plan, measured, state).tool;
    other = tick(plan, other, copy).tool;
    ASSERT_EQ(measured, other);
  }
  EXPECT_EQ(state, copy);
}

TEST(FastController, RefusesSettingsOutOfRange) {
  const auto refused = [](const std::function<void(FastSettings&)>& change) {
    ControllerSettings settings = fast_settings();
    change(settings.fast);
    EXPECT_THROW((void)prepare({"corner", kCorner}, settings), InputError);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, 0.09, 1.01, -1.0, kNaN}) {
    ControllerSettings settings = fast_settings(bad);
    EXPECT_THROW((void)prepare({"p", {named_waypoint("a", Pose{})}}, settings), InputError) << bad;
  }
  for (const double bad : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
    refused([&](FastSettings& fast) { fast.held.max_acceleration = bad; });
    refused([&](FastSettings& fast) { fast.lift_swing = bad; });
    refused([&](FastSettings& fast) { fast.blend = bad; });
    refused([&](FastSettings& fast) { fast.press_force = bad; });
  }
}

TEST(Tracking, WordsAndKindsAreOneToOne) {
  for (const Tracking& tracking : {Tracking(LaggedTracking{}), Tracking(ExactTracking{}), Tracking(FastTracking{})}) {
    EXPECT_EQ(tracking_of(name_of(tracking), "test"), tracking);
  }
  EXPECT_THROW((void)tracking_of("quick", "test"), InputError);
}

}  // namespace
}  // namespace snug::motion
