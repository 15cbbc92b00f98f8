// Tests of motions of bounded jerk: limits at every instant, closed forms, swings that are left over, corner cases.
#include "snug/motion/paced_segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::motion {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, kPathParts> all(double rate) {
  std::array<double, kPathParts> rates{};
  rates.fill(rate);
  return rates;
}

TEST(PathProfile, WithoutSpeedLimitTakesTheTriangleAndTheWindow) {
  for (const double acceleration : {0.3, 4.0, 50.0}) {
    const PathProfile profile(all(kInfinity), all(acceleration), {0.1, 0.0});
    EXPECT_NEAR(profile.duration(), 2.0 / std::sqrt(acceleration) + 0.1, 1e-12) << "2 sqrt(L / a), L = 1";
  }
}

TEST(PathProfile, OfAConstantLimitIsNearlyTheTrapezoid) {
  // The speed is reached at the end of a part: at most one part at either end takes up to twice as long.
  const double speed = 0.5, acceleration = 4.0, trapezoid = 1.0 / speed + speed / acceleration;
  const double duration = PathProfile(all(speed), all(acceleration), {0.1, 0.0}).duration() - 0.1;
  EXPECT_GE(duration, trapezoid - 1e-12);
  EXPECT_LE(duration, trapezoid + 2.0 / (kPathParts * speed));
}

TEST(PathProfile, SpeedsUpInEachPartAsFastAsThatPartAllows) {
  auto accelerations = all(4.0);
  for (std::size_t i = 0; i < accelerations.size() / 2; ++i) accelerations[i] = 1.0;
  // v^2 is 1 in the middle; then 1 + 8 x = 8 (1 / 2 - x) where it is largest: x = 6 / 32, v^2 = 2.5.
  const PathProfile profile(all(kInfinity), accelerations, {0.1, 0.0});
  EXPECT_NEAR(profile.duration(), 1.0 + (2.0 * std::sqrt(2.5) - 1.0) / 4.0 + 0.1, 1e-12);
}

TEST(PathProfile, KeepsSpeedAccelerationAndJerkAtEveryInstant) {
  Rng rng = Rng(3).split("path profile");
  for (int i = 0; i < 10; ++i) {
    SCOPED_TRACE(i);
    auto rates = all(kInfinity);
    for (double& rate : rates) rate = rng.uniform(0.2, 2.0);
    const double acceleration = rng.uniform(0.5, 20.0), window = rng.uniform(0.05, 0.4);
    const double delay = i % 2 == 0 ? 0.0 : rng.uniform(0.05, 0.3);
    const PathProfile profile(rates, all(acceleration), {window, delay});
    const double dt = 1e-4;
    double last = 0.0, last_rate = 0.0, last_change = 0.0;
    for (double t = dt; t < profile.duration() + 0.01; t += dt) {
      const PathProfile::Sample at = profile.sample(t);
      // The average over the window covers the parts that were passed within it: the fastest of all bounds it.
      EXPECT_LE(at.rate, *std::ranges::max_element(rates) + 1e-9);
      EXPECT_NEAR(at.share - last, 0.5 * dt * (at.rate + last_rate), 1e-7) << "the rate is the derivative";
      const double change = (at.rate - last_rate) / dt;
      EXPECT_LE(std::abs(change), acceleration * (1.0 + 1e-6));
      if (t > 2.0 * dt) {
        EXPECT_LE(std::abs(change - last_change) / dt, 2.0 * acceleration / window * (1.0 + 1e-4) + 1e-3);
      }
      last = at.share;
      last_rate = at.rate;
      last_change = change;
    }
    EXPECT_EQ(profile.sample(profile.duration()).share, 1.0);
    EXPECT_EQ(profile.sample(profile.duration()).rate, 0.0);
    EXPECT_EQ(profile.sample(0.0).share, 0.0);
    EXPECT_EQ(profile.sample(-1.0).share, 0.0);
  }
}

/// Amplitude, per length of the way, of an undamped swing of this period after the motion.
double residual_swing(const PathProfile& profile, double period) {
  const double omega = 2.0 * std::numbers::pi / period, dt = 1e-4;
  double x = 0.0, v = 0.0;
  for (double t = 0.0; t < profile.duration() + dt; t += dt) {  // semi-implicit: keeps the amplitude
    v += dt * omega * omega * (profile.sample(t).share - x);
    x += dt * v;
  }
  return std::hypot(x - 1.0, v / omega);
}

/// What a moving average leaves of a swing.
double share_left(double window, double period) {
  const double x = std::numbers::pi * window / period;
  return std::abs(std::sin(x) / x);
}

TEST(PathProfile, LeavesTheShareOfASwingThatItsWindowLeaves) {
  const PathProfile shaped(all(1.0), all(6.0), {0.25, 0.0}), hasty(all(1.0), all(6.0), {0.01, 0.0});
  double largest = 0.0;
  for (double period = 0.10; period < 0.35; period += 0.005) {
    const double without = residual_swing(hasty, period) / share_left(0.01, period);
    largest = std::max(largest, without);
    // 2e-4: what the integrator makes of it.
    EXPECT_NEAR(residual_swing(shaped, period), share_left(0.25, period) * without, 2e-4) << period;
  }
  EXPECT_GT(largest, 0.02) << "without the window it swings";
  for (const double period : {0.25, 0.125}) EXPECT_LT(residual_swing(shaped, period), 2e-4) << period;
}

TEST(PathProfile, WithAShaperLeavesNothingOfASecondSwing) {
  const double slow = 0.42, fast = 0.31;
  const PathProfile once(all(1.0), all(6.0), {slow, 0.0}), twice(all(1.0), all(6.0), {slow, 0.5 * fast});
  EXPECT_GT(residual_swing(once, fast), 0.005) << "without the shaper it swings";
  for (const double period : {slow, fast}) EXPECT_LT(residual_swing(twice, period), 2e-4) << period;
  // A shaper leaves |cos(pi delay / T)| of any swing, 2e-4: as above.
  for (double period = 0.2; period < 0.5; period += 0.02) {
    const double left = std::abs(std::cos(std::numbers::pi * 0.5 * fast / period));
    EXPECT_NEAR(residual_swing(twice, period), left * residual_swing(once, period), 2e-4) << period;
  }
  EXPECT_NEAR(twice.duration(), once.duration() + 0.5 * fast, 1e-12);
}

class HalfInTheMiddle final : public PathLimits {
 public:
  void limit(const Way&, std::span<double> rates, std::span<double>) const noexcept override {
    for (std::size_t i = rates.size() / 3; i < 2 * rates.size() / 3; ++i) rates[i] = std::min(rates[i], 0.25);
  }
};

TEST(PacedSegment, KeepsItsLimitsAndMeetsBothEnds) {
  Rng rng = Rng(5).split("paced segment");
  const Pace pace{0.7, 3.0, 2.0, 4.0, 0.15};
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const auto vector = [&](double size) {
      return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
    };
    const Pose X_WA{exp_rotation(vector(2.0)), vector(1.0)};
    const Pose X_WB{exp_rotation(vector(1.5)) * X_WA.R, X_WA.p + vector(0.6)};
    const auto axis = i % 2 == 0 ? std::nullopt : std::optional<PanAxis>(PanAxis{vector(0.3)});
    const PacedSegment segment(Way(X_WA, X_WB, axis), pace, nullptr);
    EXPECT_LT((segment.sample(0.0).X_WE.p - X_WA.p).norm(), 1e-12);
    EXPECT_EQ(segment.sample(segment.duration()).X_WE, X_WB);
    const double dt = 1e-3;
    Twist last;
    for (double t = dt; t < segment.duration(); t += dt) {
      const ToolState at = segment.sample(t);
      EXPECT_LE(at.V_WE.linear.norm(), pace.max_speed + 1e-9);
      EXPECT_LE(at.V_WE.angular.norm(), pace.max_turn_speed + 1e-9);
      EXPECT_LE((at.V_WE.linear - last.linear).norm(), dt * pace.max_acceleration * 1.001);
      EXPECT_LE((at.V_WE.angular - last.angular).norm(), dt * pace.max_turn_acceleration * 1.001);
      last = at.V_WE;
    }
  }
}

/// m/s^2, the largest on the way.
double fastest_change(const PacedSegment& segment) {
  double most = 0.0, last = 0.0;
  const double dt = 1e-3;
  for (double t = dt; t <= segment.duration(); t += dt) {
    const double speed = segment.sample(t).V_WE.linear.norm();
    most = std::max(most, std::abs(speed - last) / dt);
    last = speed;
  }
  return most;
}

TEST(PacedSegment, SpeedsUpFasterWhereTheAverageKeepsTheLimit) {
  const Way way(Pose{}, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -0.5)});
  const double speed = 0.6, limit = 4.0, window = 0.2, trapezoid = 0.5 / speed + 0.5 * speed / limit;
  const auto part = 2.0 * 0.5 / (kPathParts * speed);  // the speed is reached at the end of a part
  const PacedSegment averaged(way, {speed, limit, 1.0, 1.0, window, 0.0}, nullptr);
  EXPECT_LE(averaged.duration(), trapezoid + window + part) << "0.6 m/s < 4 m/s2 * 0.2 s";
  EXPECT_LE(fastest_change(averaged), limit * 1.001);
  // Half of the motion later: only its first half speeds up faster, since its end may be in contact.
  const PacedSegment shaped(way, {speed, limit, 1.0, 1.0, 0.1, 0.2}, nullptr);
  const double both_ends = 0.5 / speed + speed / limit;
  EXPECT_LE(shaped.duration(), both_ends - 0.25 * speed / limit + 0.1 + 0.2 + part);
  EXPECT_LE(fastest_change(shaped), limit * 1.001);
  // A little too fast: slower pays.
  const double faster = 0.9;
  const PacedSegment slowed(way, {faster, limit, 1.0, 1.0, window, 0.0}, nullptr);
  EXPECT_LE(slowed.duration(), 0.5 / faster + 0.8 * faster / limit + window);
  EXPECT_LE(fastest_change(slowed), limit * 1.001);
  // Too fast for either: as slow as the limit asks.
  const PacedSegment plain(way, {speed, limit, 1.0, 1.0, 0.1, 0.0}, nullptr);
  EXPECT_GE(plain.duration(), both_ends + 0.1 - 1e-9);
  EXPECT_LE(fastest_change(plain), limit * 1.001);
}

TEST(PacedSegment, KeepsToWhatElseLimitsIt) {
  const Pose X_WB{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  const Pace pace{2.0, 5.0, 2.0, 5.0, 0.1};
  const HalfInTheMiddle others;
  const PacedSegment free({Pose{}, X_WB}, pace, nullptr), limited({Pose{}, X_WB}, pace, &others);
  EXPECT_GT(limited.duration(), free.duration() + 0.5);
  for (double t = 0.0; t < limited.duration(); t += 1e-3) {
    const double x = limited.sample(t).X_WE.p.x();
    // Where the whole window lies in the slow part.
    if (x > 0.38 && x < 0.62) {
      EXPECT_LE(limited.sample(t).V_WE.linear.norm(), 0.25 + 1e-9) << x;
    }
  }
}

TEST(PacedSegment, OfNoMotionIsAtItsEndAtOnce) {
  const Pose X_WA{exp_rotation(Vector3(0.1, 0.2, 0.3)), Vector3(1.0, 2.0, 3.0)};
  const PacedSegment segment({X_WA, X_WA}, Pace{}, nullptr);
  EXPECT_EQ(segment.duration(), 0.0);
  EXPECT_EQ(segment.sample(0.0).X_WE, X_WA);
  EXPECT_EQ(segment.direction_W().norm(), 0.0);
}

}  // namespace
}  // namespace snug::motion
