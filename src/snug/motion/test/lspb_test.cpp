// Tests of the trapezoidal segments: limits, minimum time, end points, continuity, corner cases.
#include "snug/motion/lspb.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "snug/core/rng.hpp"

namespace snug::motion {
namespace {

using std::numbers::pi;

double log_uniform(Rng& rng, double low, double high) { return low * std::pow(high / low, rng.uniform()); }

Vector3 random_unit(Rng& rng) {
  Vector3 v;
  do v = Vector3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
  while (v.norm() < 0.1);
  return v.normalized();
}

struct Case {
  Pose X_WA;
  Pose X_WB;
  MotionLimits limits;
};

Case random_case(Rng& rng) {
  Case c;
  c.limits = {0.005, log_uniform(rng, 0.01, 100.0), log_uniform(rng, 0.01, 100.0), log_uniform(rng, 0.01, 100.0),
              log_uniform(rng, 0.01, 100.0)};
  c.X_WA = {exp_rotation(rng.uniform(0.0, pi) * random_unit(rng)), random_unit(rng)};
  const double angle = rng.index(8) == 0 ? 0.0 : rng.index(8) == 0 ? pi : log_uniform(rng, 1e-6, pi);
  const double length = rng.index(8) == 0 ? 0.0 : log_uniform(rng, 1e-6, 3.0);
  c.X_WB = {c.X_WA.R * exp_rotation(angle * random_unit(rng)), c.X_WA.p + length * random_unit(rng)};
  return c;
}

/// Textbook minimum time of a rest-to-rest motion, written without the code under test.
double minimum_time(double length, double speed, double acceleration) {
  const double reached = std::sqrt(length * acceleration);
  return reached <= speed ? 2.0 * reached / acceleration : speed / acceleration + length / speed;
}

/// Times that hit every phase: random ones and the borders.
std::vector<double> test_times(const LspbSegment& segment, Rng& rng) {
  std::vector<double> times = {0.0, segment.duration()};
  for (const LspbProfile& profile : {segment.translation(), segment.rotation()}) {
    times.push_back(profile.blend_time);
    times.push_back(segment.duration() - profile.blend_time);
  }
  for (int i = 0; i < 40; ++i) times.push_back(rng.uniform(0.0, segment.duration()));
  return times;
}

TEST(Lspb, IsNeverAboveALimit) {
  Rng rng = Rng(7).split("limits");
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    // Ten roundings; t_s = T - L / v of a stretched part loses digits as T / t_s.
    const auto room = [](const LspbProfile& profile) {
      return 1.0 + 2e-15 * (1.0 + (profile.blend_time > 0.0 ? profile.duration / profile.blend_time : 0.0));
    };
    const double line_room = room(segment.translation());
    const double turn_room = room(segment.rotation());
    for (const double t : test_times(segment, rng)) {
      const LspbSegment::Sample s = segment.sample(t);
      EXPECT_LE(s.V_WE.linear.norm(), c.limits.max_speed * line_room);
      EXPECT_LE(s.V_WE.angular.norm(), c.limits.max_turn_speed * turn_room);
      EXPECT_LE(s.A_WE.linear.norm(), c.limits.max_acceleration * line_room);
      EXPECT_LE(s.A_WE.angular.norm(), c.limits.max_turn_acceleration * turn_room);
    }
  }
}

TEST(Lspb, TakesTheMinimumTimeOfItsSlowerPart) {
  Rng rng = Rng(7).split("time");
  int turns_decide = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    const double length = (c.X_WB.p - c.X_WA.p).norm();
    const double angle = angle_between(c.X_WA.R, c.X_WB.R);
    const double line_time = minimum_time(length, c.limits.max_speed, c.limits.max_acceleration);
    const double turn_time = minimum_time(angle, c.limits.max_turn_speed, c.limits.max_turn_acceleration);
    turns_decide += turn_time > line_time ? 1 : 0;
    // The angle of a turn by 1e-6 rad carries the rounding of rotation matrices, 1e-16 / 1e-6 relative; a turn that
    // is pure rounding (below 1e-14) adds up to 2 sqrt(1e-14 / 0.01) s to neither.
    if (angle > 1e-14 || length > 0.0) {
      EXPECT_NEAR(segment.duration(), std::max(line_time, angle > 1e-14 ? turn_time : 0.0), 1e-9 * segment.duration());
    }
    EXPECT_EQ(segment.translation().duration, segment.rotation().duration);
  }
  EXPECT_GT(turns_decide, 1000);  // both kinds are really tested
  EXPECT_LT(turns_decide, 2000);
}

TEST(Lspb, StartsAndEndsExactlyAtItsPosesAtRest) {
  Rng rng = Rng(7).split("ends");
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    const double T = segment.duration();
    for (const double t : {T, std::nextafter(T, 1e9), T + 1.0, 1e300}) {
      EXPECT_EQ(segment.sample(t).X_WE, c.X_WB);
      EXPECT_EQ(segment.sample(t).V_WE, Twist{});
      EXPECT_EQ(segment.sample(t).A_WE, Twist{});
    }
    if (T <= 0.0) continue;
    for (const double t : {0.0, -1e-300, -5.0}) {
      EXPECT_EQ(segment.sample(t).X_WE, c.X_WA);
      EXPECT_EQ(segment.sample(t).V_WE, Twist{});
    }
    // Just before the end: the formula, not the stored pose.
    const Pose late = segment.sample(T * (1.0 - 1e-12)).X_WE;
    EXPECT_LT((late.p - c.X_WB.p).norm(), 1e-11);
    EXPECT_LT(angle_between(late.R, c.X_WB.R), 1e-11);
  }
}

TEST(Lspb, MovesOnAStraightLineAndTurnsAboutAFixedAxis) {
  Rng rng = Rng(7).split("line");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    const double length = segment.translation().length;
    const double angle = segment.rotation().length;
    for (const double t : test_times(segment, rng)) {
      const Pose X = segment.sample(t).X_WE;
      const double s = length > 0.0 ? (X.p - c.X_WA.p).norm() / length : 0.0;
      // Report eqs (4), (7): roundings of positions of size 4 and of rotations.
      EXPECT_LT((X.p - (c.X_WA.p + s * (c.X_WB.p - c.X_WA.p))).norm(), 1e-14);
      EXPECT_LE(s, 1.0 + 1e-15 / std::max(length, 1e-15));
      EXPECT_NEAR(angle_between(c.X_WA.R, X.R) + angle_between(X.R, c.X_WB.R), angle, 1e-13);
    }
  }
}

TEST(Lspb, HasContinuousSpeedThatIntegratesToThePosition) {
  Rng rng = Rng(7).split("integral");
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const Case c = random_case(rng);
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    for (const LspbProfile& profile : {segment.translation(), segment.rotation()}) {
      const double T = profile.duration;
      std::vector<double> times = test_times(segment, rng);
      std::sort(times.begin(), times.end());
      double position = 0.0;
      for (std::size_t k = 1; k < times.size(); ++k) {
        const auto before = profile.sample(times[k - 1]);
        const auto after = profile.sample(times[k]);
        // Speed is linear between neighbours (the borders are among the times), so the trapezoid rule is exact.
        position += 0.5 * (before.speed + after.speed) * (times[k] - times[k - 1]);
        EXPECT_NEAR(after.position, position, 1e-11 * profile.length);
        EXPECT_LE(std::abs(after.speed - before.speed),
                  profile.acceleration() * (times[k] - times[k - 1]) * (1.0 + 1e-9) + 1e-11 * profile.peak_speed);
        EXPECT_GE(after.speed, 0.0);
        EXPECT_GE(after.position, before.position);
      }
      EXPECT_EQ(profile.sample(T).position, profile.length);
    }
  }
}

TEST(Lspb, GivesTheTwistOfItsPose) {
  Rng rng = Rng(7).split("twist");
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    Case c = random_case(rng);
    c.limits = {0.005, 3.0, 0.5, 2.0, 1.5};
    c.X_WB = {c.X_WA.R * exp_rotation(rng.uniform(0.1, pi) * random_unit(rng)), c.X_WA.p + random_unit(rng)};
    const LspbSegment segment(c.X_WA, c.X_WB, c.limits);
    const double h = 1e-5;
    const double t = rng.uniform(h, segment.duration() - h);
    const Pose X_before = segment.sample(t - h).X_WE;
    const Pose X_after = segment.sample(t + h).X_WE;
    const LspbSegment::Sample s = segment.sample(t);
    // Central difference: h times the acceleration step if a phase border lies inside, else rounding 1e-16 / h.
    EXPECT_LT(((X_after.p - X_before.p) / (2.0 * h) - s.V_WE.linear).norm(), 2e-5);
    EXPECT_LT((log_rotation(X_after.R * X_before.R.transpose()) / (2.0 * h) - s.V_WE.angular).norm(), 2e-5);
  }
}

TEST(Lspb, HasTheClosedFormOfThreePhases) {
  // 1 m at 0.5 m/s and 2 m/s^2: blend 0.25 s, T = 2.25 s.
  const Pose X_WB{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  const LspbSegment segment(Pose{}, X_WB, {0.005, 2.0, 0.5, 1.0, 1.0});
  EXPECT_DOUBLE_EQ(segment.duration(), 2.25);
  EXPECT_DOUBLE_EQ(segment.sample(0.125).X_WE.p.x(), 0.5 * 2.0 * 0.125 * 0.125);        // eq. (9), first
  EXPECT_DOUBLE_EQ(segment.sample(1.0).X_WE.p.x(), 0.5 * 1.0 - 0.5 * 0.25 / 2.0);       // eq. (9), second
  EXPECT_DOUBLE_EQ(segment.sample(2.125).X_WE.p.x(), 1.0 - 0.5 * 2.0 * 0.125 * 0.125);  // eq. (9), third
  EXPECT_DOUBLE_EQ(segment.sample(2.125).V_WE.linear.x(), 0.25);                        // eq. (10) without the square
  EXPECT_DOUBLE_EQ(segment.sample(2.125).A_WE.linear.x(), -2.0);
  EXPECT_EQ(segment.sample(1.0).A_WE.linear.x(), 0.0);
}

TEST(Lspb, StretchesTheFasterPartWithTwoPhasesWhileTheSpeedAllowsIt) {
  // The turn takes 2 s (two phases of 1 s); 0.4 m fit into them at a peak of 0.4 m/s, 0.8 m at 0.5 m/s do not.
  const MotionLimits limits{0.005, 3.0, 0.5, 2.0, 1.0};
  const Matrix3 R_WB = exp_rotation(Vector3(0.0, 0.0, 1.0));
  const LspbSegment slow(Pose{}, {R_WB, Vector3(0.4, 0.0, 0.0)}, limits);
  EXPECT_NEAR(slow.duration(), 2.0, 1e-15);
  EXPECT_NEAR(slow.translation().peak_speed, 0.4, 1e-15);
  EXPECT_NEAR(slow.translation().blend_time, 1.0, 1e-15);
  const LspbSegment fast(Pose{}, {R_WB, Vector3(0.8, 0.0, 0.0)}, limits);
  EXPECT_NEAR(fast.duration(), 2.0, 1e-15);
  EXPECT_EQ(fast.translation().peak_speed, 0.5);
  EXPECT_NEAR(fast.translation().blend_time, 2.0 - 0.8 / 0.5, 1e-15);
}

TEST(Lspb, OfNothingTakesNoTimeAndStaysExactlyThere) {
  const Pose X{exp_rotation(Vector3(0.3, -2.0, 1.0)), Vector3(0.1, 0.2, 0.3)};
  const LspbSegment segment(X, X, {});
  EXPECT_EQ(segment.duration(), 0.0);
  for (const double t : {-1.0, 0.0, 1e-300, 1.0}) {
    EXPECT_EQ(segment.sample(t).X_WE, X);
    EXPECT_EQ(segment.sample(t).V_WE, Twist{});
  }
  EXPECT_EQ(LspbSegment().duration(), 0.0);
  EXPECT_EQ(segment.with_sampled_coast(0.008), segment);
}

TEST(Lspb, OfAPureTurnKeepsThePositionAndOfAPureShiftTheRotation) {
  const Pose X_WA{exp_rotation(Vector3(0.3, -2.0, 1.0)), Vector3(0.1, 0.2, 0.3)};
  const LspbSegment turn(X_WA, {X_WA.R * exp_rotation(Vector3(0.0, 0.7, 0.0)), X_WA.p}, {});
  EXPECT_GT(turn.duration(), 0.5);
  EXPECT_EQ(turn.sample(0.3).X_WE.p, X_WA.p);
  EXPECT_EQ(turn.sample(0.3).V_WE.linear, Vector3::Zero());
  const LspbSegment shift(X_WA, {X_WA.R, X_WA.p + Vector3(0.0, 1.0, 0.0)}, {});
  EXPECT_EQ(shift.sample(0.3).X_WE.R, X_WA.R);
  EXPECT_EQ(shift.sample(0.3).V_WE.angular, Vector3::Zero());
}

TEST(Lspb, OfTinyMovesIsFiniteAndExact) {
  for (const double size : {1e-12, 1e-13, 1e-15, 1e-150, 1e-300, 5e-324}) {
    SCOPED_TRACE(size);
    const Pose X_WB{exp_rotation(Vector3(size, 0.0, 0.0)), Vector3(0.0, size, 0.0)};
    const LspbSegment segment(Pose{}, X_WB, {});
    EXPECT_TRUE(std::isfinite(segment.duration()));
    for (const double part : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const LspbSegment::Sample s = segment.sample(part * segment.duration());
      EXPECT_TRUE(s.X_WE.p.allFinite() && s.X_WE.R.allFinite() && as_vector(s.V_WE).allFinite());
      EXPECT_LE(s.X_WE.p.norm(), size);
    }
    EXPECT_EQ(segment.sample(segment.duration()).X_WE, X_WB);
  }
}

TEST(Lspb, OfAHalfTurnChoosesOneAxisAlways) {
  for (const Vector3& axis :
       {Vector3(0.0, 0.0, 1.0), Vector3(0.0, -1.0, 0.0), Vector3(1.0, -2.0, 0.5).normalized().eval()}) {
    const Pose X_WB{exp_rotation(pi * axis), Vector3::Zero()};
    const Pose X_WB_other{exp_rotation(-pi * axis), Vector3::Zero()};
    const LspbSegment one(Pose{}, X_WB, {});
    const LspbSegment other(Pose{}, X_WB_other, {});
    EXPECT_NEAR(one.rotation().length, pi, 1e-12);
    EXPECT_NEAR(std::abs(one.axis_W().dot(axis)), 1.0, 1e-12);
    EXPECT_LT((one.axis_W() - other.axis_W()).norm(), 1e-12);
    EXPECT_NEAR(angle_between(one.sample(0.5 * one.duration()).X_WE.R, X_WB.R), 0.5 * pi, 1e-9);
  }
}

TEST(Lspb, WithHugeOrTinyLimitsStaysFinite) {
  const Pose X_WB{exp_rotation(Vector3(0.0, 3.0, 0.0)), Vector3(1.0, 0.0, 0.0)};
  for (const double a : {1e-100, 1e-9, 1.0, 1e9, 1e100}) {
    for (const double v : {1e-100, 1e-9, 1.0, 1e9, 1e100}) {
      SCOPED_TRACE(testing::Message() << "v " << v << " a " << a);
      const LspbSegment segment(Pose{}, X_WB, {0.005, a, v, v, a});
      const double T = segment.duration();
      ASSERT_TRUE(std::isfinite(T) && T > 0.0);
      for (int k = 0; k <= 20; ++k) {
        const LspbSegment::Sample s = segment.sample(T * k / 20.0);
        EXPECT_TRUE(s.X_WE.p.allFinite() && s.X_WE.R.allFinite() && as_vector(s.V_WE).allFinite());
        EXPECT_LE(s.X_WE.p.x(), 1.0 + 1e-12);
        EXPECT_GE(s.X_WE.p.x(), 0.0);
        EXPECT_LE(s.V_WE.linear.norm(), v * (1.0 + 1e-12));
      }
    }
  }
}

TEST(LspbDeathTest, RefusesLimitsAndPosesThatAreNotNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose X_WB{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  EXPECT_DEATH((void)LspbSegment(Pose{}, X_WB, {0.005, -1.0, 0.5, 1.0, 1.0}), "finite and positive");
  EXPECT_DEATH((void)LspbSegment(Pose{}, X_WB, {0.005, 1.0, nan, 1.0, 1.0}), "finite and positive");
  EXPECT_DEATH((void)LspbSegment(Pose{}, X_WB, {0.005, 1.0, 0.5, 0.0, 1.0}), "finite and positive");
  EXPECT_DEATH((void)LspbSegment(Pose{}, {Matrix3::Identity(), Vector3(nan, 0.0, 0.0)}, {}), "finite");
}

TEST(LspbSampledCoast, RunsAtTheLastSampleOfTheBlendAndJumpsByHalfTheGapAtBothEnds) {
  // 1 m at 0.35 m/s and 3 m/s^2: the blend of 0.11667 s has its last sample at tick 14, at 3 * 0.112 = 0.336 m/s.
  const Pose X_WB{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  const LspbSegment exact(Pose{}, X_WB, {0.005, 3.0, 0.35, 1.0, 1.0});
  const LspbSegment segment = exact.with_sampled_coast(0.008);
  EXPECT_EQ(segment.duration(), exact.duration());
  EXPECT_NEAR(segment.translation().coast_speed, 0.336, 1e-12);
  const double blend = segment.translation().blend_time;
  const double coast_time = segment.duration() - 2.0 * blend;
  const double jump = 0.5 * (0.35 - 0.336) * coast_time;
  const double h = 1e-9;
  const auto x = [&](double t) { return segment.sample(t).X_WE.p.x(); };
  EXPECT_NEAR(x(blend + h) - x(blend - h), jump, 1e-8);
  EXPECT_NEAR(x(segment.duration() - blend + h) - x(segment.duration() - blend - h), jump, 1e-8);
  EXPECT_NEAR(x(0.5 * segment.duration()), 0.5, 1e-12);
  EXPECT_EQ(segment.sample(segment.duration()).X_WE, X_WB);
}

TEST(LspbSampledCoast, KeepsTheTrueSpeedWhenTheBlendIsShorterThanATick) {
  const Pose X_WB{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  const LspbSegment exact(Pose{}, X_WB, {0.005, 1000.0, 0.5, 1.0, 1.0});
  EXPECT_EQ(exact.with_sampled_coast(0.008), exact);
}

}  // namespace
}  // namespace snug::motion
