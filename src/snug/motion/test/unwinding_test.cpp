// Unwinding: the yaw that a controller really turns through stays near neutral, however long the program.
#include "snug/motion/unwinding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::motion {
namespace {

using std::numbers::pi;

Matrix3 pointing_down(double yaw, double tilt = 0.0) {
  return exp_rotation(Vector3(tilt, 0.0, 0.0)) * exp_rotation(Vector3(0.0, 0.0, yaw)) *
         exp_rotation(Vector3(0.0, pi, 0.0));
}

Waypoint row_at(double yaw, double tilt = 0.0) {
  return {{pointing_down(yaw, tilt), Vector3(0.1, 0.2, 0.3)}, "Row", {}, 0};
}

/// About the vertical, the shorter way: what a controller does between two rows.
double turn_between(const Waypoint& from, const Waypoint& to) {
  return log_rotation(to.X_WE.R * from.X_WE.R.transpose()).z();
}

TEST(YawOf, IsThatOfAToolThatPointsDownAndNothingElse) {
  for (double yaw = -3.1; yaw < 3.1; yaw += 0.1) {
    ASSERT_TRUE(yaw_of(pointing_down(yaw)));
    EXPECT_NEAR(*yaw_of(pointing_down(yaw)), yaw, 1e-12);
    EXPECT_TRUE(upright_tool(yaw).isApprox(pointing_down(yaw), 1e-12));
    EXPECT_NEAR(*yaw_of(pointing_down(yaw, 0.2)), yaw, 0.011) << "tilted a little";  // up to (1 - cos 0.2) / 2
  }
  EXPECT_FALSE(yaw_of(pointing_down(0.3, 0.5 * pi)));
  EXPECT_FALSE(yaw_of(Matrix3::Identity()));
}

TEST(WithTurns, AddsNothingToTurnsThatAreSure) {
  const auto rows = with_turns(row_at(-1.2), {row_at(1.2), row_at(-0.5), row_at(-0.5, pi / 2), row_at(1.5)}, 0.0);
  EXPECT_EQ(rows.size(), 4u);
}

TEST(WithTurns, TurnsOnTheSpotOverTheNeutralSideWhenTheTurnIsHalfATurn) {
  Waypoint before = row_at(-0.5 * pi);
  before.io.vacuum = true;
  for (const double off : {-0.02, 0.0, 0.02}) {
    const auto rows = with_turns(before, {row_at(0.5 * pi + off)}, 0.0);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].name, "Row_turn");
    EXPECT_TRUE(rows[0].io.vacuum);
    EXPECT_EQ(rows[0].X_WE.p, before.X_WE.p);
    EXPECT_NEAR(*yaw_of(rows[0].X_WE.R), 0.5 * off, 1e-12);
    EXPECT_NEAR(turn_between(before, rows[0]) + turn_between(rows[0], rows[1]), pi + off, 1e-12);
  }
  // With another neutral the other way.
  const auto other = with_turns(row_at(0.5 * pi), {row_at(-0.5 * pi)}, pi);
  ASSERT_EQ(other.size(), 2u);
  EXPECT_NEAR(std::abs(*yaw_of(other[0].X_WE.R)), pi, 1e-12);
}

TEST(WithTurns, TurnsOnTheWayWhereThatIsWanted) {
  const Waypoint before = row_at(-0.6 * pi);
  Waypoint goal = row_at(0.6 * pi);
  goal.X_WE.p += Vector3(1.0, -0.4, 0.2);
  goal.io.vacuum = true;
  const auto rows = with_turns(before, {goal}, 0.0, true);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[0].io.vacuum) << "it is already on the way to the row";
  EXPECT_TRUE(rows[0].X_WE.p.isApprox(before.X_WE.p + Vector3(0.5, -0.2, 0.1)));
  EXPECT_NEAR(turn_between(before, rows[0]), 0.6 * pi, 1e-12);
  EXPECT_EQ(rows[1].X_WE, goal.X_WE);
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

TEST(WithTurns, KeepsTheToolUnwoundOverAnyProgram) {
  Rng rng(5);
  for (const double neutral : {0.0, 1.0, -2.5}) {
    Waypoint before = row_at(neutral);
    double accumulated = 0.0;
    for (int i = 0; i < 500; ++i) {
      const double yaw = neutral + rng.uniform(-0.99 * pi, 0.99 * pi);
      for (const Waypoint& row : with_turns(before, {row_at(yaw, rng.uniform(-0.1, 0.1))}, neutral)) {
        const double turn = turn_between(before, row);
        EXPECT_LT(std::abs(turn), 155.0 * pi / 180.0);
        accumulated += turn;
        before = row;
      }
      // Little tilts make the shorter way a little different from a turn about the vertical: not a whole one.
      const double wanted = std::remainder(yaw - neutral, 2.0 * pi);
      EXPECT_NEAR(std::remainder(*yaw_of(before.X_WE.R) - neutral, 2.0 * pi), wanted, 0.02);
      EXPECT_LT(std::abs(accumulated), 4.0 + 1e-3 * i);
    }
  }
}

Waypoint row_over(double x, double y, double z) { return {{pointing_down(0.0), Vector3(x, y, z)}, "Row", {}, 0}; }

TEST(WithDetours, LeadsAroundTheBaseOnTheSideOfTheStraightWay) {
  const Vector3 p_WB(0.1, 0.0, 0.0);
  const auto rows = with_detours(row_over(0.5, -0.2, 0.3), {row_over(-0.4, -0.2, 0.2)}, p_WB, 0.3, 0.4);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].name, "Row_around");
  EXPECT_TRUE(rows[0].X_WE.p.isApprox(Vector3(0.1, -0.4, 0.3), 1e-12));
  // Far enough, too short, and with the tool tilted: as they are.
  EXPECT_EQ(with_detours(row_over(0.5, -0.35, 0.3), {row_over(-0.4, -0.35, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
  EXPECT_EQ(with_detours(row_over(0.2, -0.2, 0.3), {row_over(0.0, -0.2, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
  Waypoint tilted = row_over(-0.4, -0.2, 0.2);
  tilted.X_WE.R = pointing_down(0.0, 1.2);
  EXPECT_EQ(with_detours(row_over(0.5, -0.2, 0.3), {tilted}, p_WB, 0.3, 0.4).size(), 1u);
  // Straight over the axis there is no better side.
  EXPECT_EQ(with_detours(row_over(0.5, 0.0, 0.3), {row_over(-0.4, 0.0, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
}

}  // namespace
}  // namespace snug::motion
