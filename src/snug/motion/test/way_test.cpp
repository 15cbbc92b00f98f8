// Tests of ways: both ends, derivatives, what is even about the robot's first axis, and where a way stays straight.
#include "snug/motion/way.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/motion/tool_yaw.hpp"

namespace snug::motion {
namespace {

const Vector3 kAxis(0.1, -0.2, 0.3);

Pose around(double radius, double azimuth, double z, double yaw) {
  return {upright_tool(yaw), kAxis + Vector3(radius * std::cos(azimuth), radius * std::sin(azimuth), z)};
}

Vector3 vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

TEST(Way, MeetsBothEndsAndIsTheIntegralOfItsSlope) {
  Rng rng = Rng(4).split("way");
  int bent = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Pose X_WA{exp_rotation(vector(rng, 1.5)), vector(rng, 0.8)};
    const Pose X_WB{exp_rotation(vector(rng, 0.9)) * X_WA.R, vector(rng, 0.8)};
    const Way way(X_WA, X_WB, i % 4 == 0 ? std::nullopt : std::optional<PanAxis>(PanAxis{kAxis}));
    bent += way.is_straight() ? 0 : 1;
    EXPECT_LT((way.at(0.0).p - X_WA.p).norm(), 1e-12);
    EXPECT_LT((way.at(1.0).p - X_WB.p).norm(), 1e-12);
    EXPECT_LT(angle_between(way.at(0.0).R, X_WA.R), 1e-7) << "acos of a rounded cosine";
    EXPECT_LT(angle_between(way.at(1.0).R, X_WB.R), 1e-7);
    const double h = 1e-5, share = rng.uniform(0.1, 0.9);
    const Pose before = way.at(share - h), after = way.at(share + h);
    const Way::Slope slope = way.slope(share);
    // Central differences: h^2 / 6 times the third derivative, and rounding over h.
    EXPECT_LT(((after.p - before.p) / (2.0 * h) - slope.first.linear).norm(), 1e-8);
    EXPECT_LT((log_rotation(after.R * before.R.transpose()) / (2.0 * h) - slope.first.angular).norm(), 1e-8);
    const Way::Slope left = way.slope(share - h), right = way.slope(share + h);
    EXPECT_LT(((right.first.linear - left.first.linear) / (2.0 * h) - slope.second.linear).norm(), 1e-8);
    EXPECT_LT(((right.first.angular - left.first.angular) / (2.0 * h) - slope.second.angular).norm(), 1e-8);
  }
  EXPECT_GT(bent, 50);
}

TEST(Way, AroundTheFirstAxisTurnsItEvenlyAndKeepsItsDistance) {
  const Pose X_WA = around(0.55, -2.3, 0.2, 0.4), X_WB = around(0.65, -0.6, 0.3, 2.0);
  const Way way(X_WA, X_WB, PanAxis{kAxis});
  EXPECT_NEAR(way.pan(), 1.7, 1e-12);
  for (double share = 0.0; share <= 1.0; share += 0.125) {
    const Pose X_WE = way.at(share);
    EXPECT_NEAR(pan_between(kAxis, X_WA.p, X_WE.p), share * 1.7, 1e-12);
    EXPECT_NEAR((X_WE.p - kAxis).head<2>().norm(), 0.55 + share * 0.10, 1e-12);
    EXPECT_NEAR(X_WE.p.z(), X_WA.p.z() + share * 0.1, 1e-12);
    EXPECT_NEAR(*yaw_of(X_WE.R), 0.4 + share * 1.6, 1e-9) << "an upright tool stays upright and turns evenly";
  }
  // A straight way between them passes at less than a third of that.
  EXPECT_LT((Way(X_WA, X_WB).at(0.5).p - kAxis).head<2>().norm(), 0.42);
}

TEST(Way, TurnsTheToolWithTheFirstAxisAndOnlyTheRestOfTheTurnTheShorterWayRound) {
  // 240 degrees of yaw, 100 of them by the first axis: the wrist has 140 left, while a fixed axis would go back by 120.
  const double degree = std::numbers::pi / 180.0;
  const Pose X_WA = around(0.5, 0.0, 0.0, 0.0), X_WB = around(0.5, 100.0 * degree, 0.0, 240.0 * degree);
  EXPECT_NEAR(*yaw_of(Way(X_WA, X_WB, PanAxis{kAxis}).at(0.5).R), 120.0 * degree, 1e-9);
  EXPECT_NEAR(*yaw_of(Way(X_WA, X_WB).at(0.5).R), -60.0 * degree, 1e-9);
}

TEST(Way, IsStraightWhereTheAxisHardlyTurnsOrTheToolIsOverIt) {
  const Pose far = around(0.5, 0.0, 0.0, 0.0);
  EXPECT_TRUE(Way(far, around(0.5, 0.19, 0.0, 0.0), PanAxis{kAxis}).is_straight());
  EXPECT_FALSE(Way(far, around(0.5, 0.21, 0.0, 0.0), PanAxis{kAxis}).is_straight());
  EXPECT_TRUE(Way(far, around(0.19, 2.0, 0.0, 0.0), PanAxis{kAxis}).is_straight());
  EXPECT_TRUE(Way(around(0.19, 2.0, 0.0, 0.0), far, PanAxis{kAxis}).is_straight());
  EXPECT_TRUE(Way(far, around(0.5, 2.0, 0.0, 0.0)).is_straight());
  const Way straight(far, around(0.4, 2.0, 0.2, 0.0));
  EXPECT_LT((straight.at(0.25).p - (0.75 * far.p + 0.25 * straight.end().p)).norm(), 1e-12);
}

TEST(Way, ToWhereTheToolIsIsNone) {
  const Pose X_WE = around(0.5, 0.0, 0.0, 1.0);
  EXPECT_FALSE(Way(X_WE, X_WE, PanAxis{kAxis}).is_motion());
  EXPECT_FALSE(Way().is_motion());
  Pose nearby = X_WE;
  nearby.p.x() += 1e-8;
  EXPECT_TRUE(Way(X_WE, nearby, PanAxis{kAxis}).is_motion());
}

TEST(PanBetween, IsTheTurnOfAVerticalAxis) {
  const Vector3 p_WB(1.0, 2.0, 0.3);
  for (const double from : {-3.0, -0.5, 2.9}) {
    for (const double turn : {-3.0, -1.0, 0.0, 0.7, 3.1}) {
      const Vector3 p_from = p_WB + 0.4 * Vector3(std::cos(from), std::sin(from), 2.0);
      const Vector3 p_to = p_WB + 0.9 * Vector3(std::cos(from + turn), std::sin(from + turn), -1.0);
      EXPECT_NEAR(pan_between(p_WB, p_from, p_to), turn, 1e-12);
    }
  }
}

}  // namespace
}  // namespace snug::motion
