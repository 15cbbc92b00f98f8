// Tests of the path between two ticks.
#include "snug/motion/tool_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

struct Ends {
  ToolState start;
  ToolState end;
};

/// Any two states up to `turn` rad apart, with rates of that size in the time of a tick.
Ends random_ends(Rng& rng, double turn) {
  Ends ends;
  ends.start.X_WE = {exp_rotation(random_vector(rng, 3.0)), random_vector(rng, 1.0)};
  ends.end.X_WE = {exp_rotation(random_vector(rng, 0.5 * turn)) * ends.start.X_WE.R,
                   ends.start.X_WE.p + random_vector(rng, 0.01)};
  ends.start.V_WE = {random_vector(rng, 1.0), random_vector(rng, turn / kTick)};
  ends.end.V_WE = {random_vector(rng, 1.0), random_vector(rng, turn / kTick)};
  return ends;
}

double distance(const Pose& a, const Pose& b) { return (a.p - b.p).norm() + angle_between(a.R, b.R); }

TEST(Interpolation, GivesBothEndsExactlyAndClamps) {
  Rng rng = Rng(7).split("ends");
  const Ends ends = random_ends(rng, 0.02);
  EXPECT_EQ(interpolate(ends.start, ends.end, kTick, 0.0), ends.start);
  EXPECT_EQ(interpolate(ends.start, ends.end, kTick, -1.0), ends.start);
  EXPECT_EQ(interpolate(ends.start, ends.end, kTick, 1.0), ends.end);
  EXPECT_EQ(interpolate(ends.start, ends.end, kTick, 2.0), ends.end);
}

TEST(Interpolation, ReachesPoseAndTwistOfBothEndsContinuously) {
  Rng rng = Rng(7).split("continuous");
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const double turn = std::pow(10.0, rng.uniform(-12.0, 0.0));
    const Ends ends = random_ends(rng, turn);
    const double near = 1e-10;
    const ToolState first = interpolate(ends.start, ends.end, kTick, near);
    const ToolState last = interpolate(ends.start, ends.end, kTick, 1.0 - near);
    // Rates change by about 10 times their size over the tick, so by 1e-9 of it over `near`; plus rounding.
    const double rate = 4.0 + 4.0 * turn / kTick;
    EXPECT_LT((as_vector(first.V_WE) - as_vector(ends.start.V_WE)).norm(), 1e-8 * rate);
    EXPECT_LT((as_vector(last.V_WE) - as_vector(ends.end.V_WE)).norm(), 1e-8 * rate);
    EXPECT_LT(distance(first.X_WE, ends.start.X_WE), 1e-11 * rate);
    EXPECT_LT(distance(last.X_WE, ends.end.X_WE), 1e-11 * rate);
  }
}

TEST(Interpolation, GivesTheTwistOfItsPose) {
  Rng rng = Rng(7).split("twist");
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Ends ends = random_ends(rng, i % 2 ? 1.0 : 0.02);
    const double s = rng.uniform(0.01, 0.99);
    const double h = 1e-5;
    const ToolState before = interpolate(ends.start, ends.end, kTick, s - h);
    const ToolState after = interpolate(ends.start, ends.end, kTick, s + h);
    const ToolState now = interpolate(ends.start, ends.end, kTick, s);
    const double dt = 2.0 * h * kTick;
    // Central difference: h^2 = 1e-10 of rates up to 1000 rad/s, and rounding 1e-16 / dt = 1e-9 of positions.
    EXPECT_LT(((after.X_WE.p - before.X_WE.p) / dt - now.V_WE.linear).norm(), 1e-7);
    EXPECT_LT((log_rotation(after.X_WE.R * before.X_WE.R.transpose()) / dt - now.V_WE.angular).norm(), 1e-5);
  }
}

TEST(Interpolation, OfConstantAccelerationIsTheParabola) {
  const Vector3 v0(0.3, -0.2, 0.1);
  const Vector3 a(2.0, 1.0, -3.0);
  ToolState start;
  start.V_WE.linear = v0;
  ToolState end;
  end.X_WE.p = kTick * (v0 + 0.5 * kTick * a);
  end.V_WE.linear = v0 + kTick * a;
  for (const double s : {0.125, 0.25, 0.5, 0.875}) {
    const ToolState state = interpolate(start, end, kTick, s);
    const double t = s * kTick;
    EXPECT_LT((state.X_WE.p - t * (v0 + 0.5 * t * a)).norm(), 1e-17);  // rounding of millimetres
    EXPECT_LT((state.V_WE.linear - (v0 + t * a)).norm(), 1e-14);
  }
}

TEST(Interpolation, OfASteadyTurnIsTheSteadyTurn) {
  const Vector3 w(0.5, -1.0, 2.0);
  ToolState start;
  start.X_WE.R = exp_rotation(Vector3(1.0, 2.0, 0.5));
  start.V_WE.angular = w;
  for (const double duration : {0.008, 0.5}) {
    ToolState end;
    end.X_WE.R = exp_rotation(duration * w) * start.X_WE.R;
    end.V_WE.angular = w;
    const ToolState state = interpolate(start, end, duration, 0.3);
    EXPECT_LT(angle_between(state.X_WE.R, exp_rotation(0.3 * duration * w) * start.X_WE.R), 1e-14);
    EXPECT_LT((state.V_WE.angular - w).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace snug::motion
