// find_knots: polynomials pass every state within the tolerance, slower than the limits, on few knots.
#include "snug/control/joint_knots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/core/rng.hpp"

namespace snug::control {
namespace {

constexpr double kStep = 0.008;

/// Two joints that swing, with random frequencies up to 1 Hz.
std::vector<TimedJoints> swinging(Rng& rng, int count) {
  const double a = rng.uniform(1.0, 6.0), b = rng.uniform(1.0, 6.0);
  std::vector<TimedJoints> states;
  for (int i = 0; i < count; ++i) {
    const double t = kStep * i;
    states.push_back({t, Eigen::Vector2d(std::sin(a * t), 0.3 * std::cos(b * t)),
                      Eigen::Vector2d(a * std::cos(a * t), -0.3 * b * std::sin(b * t))});
  }
  return states;
}

KnotLimits limits_of(double tolerance) { return {tolerance, Eigen::Vector2d(100.0, 100.0), 1e4}; }

TEST(JointKnots, PolynomialsPassEveryStateWithinTheTolerance) {
  Rng rng = Rng(3).split("knots");
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE(round);
    const std::vector<TimedJoints> states = swinging(rng, 200 + round);
    const std::vector<std::size_t> knots = find_knots(states, limits_of(1e-5));
    ASSERT_EQ(knots.back(), states.size() - 1);
    EXPECT_LT(knots.size(), states.size() / 5);
    std::size_t from = 0;
    for (const std::size_t to : knots) {
      ASSERT_GT(to, from);
      for (std::size_t i = from; i <= to; ++i) {
        const robot::JointVector q = interpolate(states[from], states[to], states[i].time);
        EXPECT_LE((q - states[i].q).cwiseAbs().maxCoeff(), 1e-5);
      }
      from = to;
    }
  }
}

TEST(JointKnots, PolynomialsKeepTheLimitsOfSpeedAndAcceleration) {
  Rng rng = Rng(4).split("knots");
  std::vector<TimedJoints> states = swinging(rng, 300);
  KnotLimits limits = limits_of(1e-2);  // wide: the limits decide
  limits.max_speed.setZero();
  limits.max_acceleration = 0.0;
  for (std::size_t i = 0; i + 1 < states.size(); ++i) {
    limits.max_speed = limits.max_speed.cwiseMax(states[i].qd.cwiseAbs());
    const double acceleration = (states[i + 1].qd - states[i].qd).cwiseAbs().maxCoeff() / kStep;
    limits.max_acceleration = std::max(limits.max_acceleration, acceleration);
  }
  std::size_t from = 0;
  for (const std::size_t to : find_knots(states, limits)) {
    const double step = (states[to].time - states[from].time) / 1000.0;
    robot::JointVector before = states[from].q, speed_before = states[from].qd;
    for (int k = 1; k <= 1000 && to > from + 1; ++k) {
      const robot::JointVector q = interpolate(states[from], states[to], states[from].time + k * step);
      const robot::JointVector speed = (q - before) / step;
      EXPECT_TRUE((speed.cwiseAbs().array() <= limits.max_speed.array() + 1e-6).all());
      const double acceleration = (speed - speed_before).cwiseAbs().maxCoeff() / step;
      EXPECT_TRUE(k == 1 || acceleration <= limits.max_acceleration + 1e-3) << acceleration;
      before = q;
      speed_before = speed;
    }
    from = to;
  }
}

TEST(JointKnots, OfARestIsOne) {
  std::vector<TimedJoints> states;
  for (int i = 0; i < 5000; ++i) states.push_back({kStep * i, Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d::Zero()});
  EXPECT_EQ(find_knots(states, limits_of(1e-6)), std::vector<std::size_t>{4999});
}

TEST(JointKnots, OfFewerThanTwoStatesAreNone) {
  std::vector<TimedJoints> states;
  EXPECT_TRUE(find_knots(states, limits_of(1e-6)).empty());
  states.push_back({0.0, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()});
  EXPECT_TRUE(find_knots(states, limits_of(1e-6)).empty());
}

TEST(JointKnots, AreAllStatesWhereNothingIsANumber) {
  const Eigen::Vector2d none = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<TimedJoints> states;
  for (int i = 0; i < 5; ++i) states.push_back({kStep * i, none, none});
  EXPECT_EQ(find_knots(states, limits_of(1e-6)), (std::vector<std::size_t>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace snug::control
