// Unwinding: the yaw that a controller really turns through stays near neutral, however long the program.
#include "snug/skills/unwinding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/way.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::skills {
namespace {

using std::numbers::pi;

Matrix3 pointing_down(double yaw, double tilt = 0.0) {
  return exp_rotation(Vector3(tilt, 0.0, 0.0)) * exp_rotation(Vector3(0.0, 0.0, yaw)) *
         exp_rotation(Vector3(0.0, pi, 0.0));
}

motion::Waypoint row_at(double yaw, double tilt = 0.0) {
  return motion::named_waypoint("Row", {pointing_down(yaw, tilt), Vector3(0.1, 0.2, 0.3)});
}

/// About the vertical, the shorter way: what a controller does between two rows.
double turn_between(const motion::Waypoint& from, const motion::Waypoint& to) {
  return log_rotation(to.X_WE.R * from.X_WE.R.transpose()).z();
}

TEST(WithTurns, AddsNothingToTurnsThatAreSure) {
  const auto rows = with_turns(row_at(-1.2), {row_at(1.2), row_at(-0.5), row_at(-0.5, pi / 2), row_at(1.5)}, {0.0});
  EXPECT_EQ(rows.size(), 4u);
}

TEST(WithTurns, TurnsOnTheSpotOverTheNeutralSideWhenTheTurnIsHalfATurn) {
  motion::Waypoint before = row_at(-0.5 * pi);
  before.io.vacuum = true;
  for (const double off : {-0.02, 0.0, 0.02}) {
    const auto rows = with_turns(before, {row_at(0.5 * pi + off)}, {0.0});
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(motion::name_of(rows[0]), "Row_turn");
    EXPECT_TRUE(rows[0].io.vacuum);
    EXPECT_EQ(rows[0].X_WE.p, before.X_WE.p);
    EXPECT_NEAR(*motion::yaw_of(rows[0].X_WE.R), 0.5 * off, 1e-12);
    EXPECT_NEAR(turn_between(before, rows[0]) + turn_between(rows[0], rows[1]), pi + off, 1e-12);
  }
  // With another neutral the other way.
  const auto other = with_turns(row_at(0.5 * pi), {row_at(-0.5 * pi)}, {pi});
  ASSERT_EQ(other.size(), 2u);
  EXPECT_NEAR(std::abs(*motion::yaw_of(other[0].X_WE.R)), pi, 1e-12);
}

TEST(WithTurns, TurnsOnTheWayWhereThatIsWanted) {
  const motion::Waypoint before = row_at(-0.6 * pi);
  motion::Waypoint goal = row_at(0.6 * pi);
  goal.X_WE.p += Vector3(1.0, -0.4, 0.2);
  goal.io.vacuum = true;
  const auto rows = with_turns(before, {goal}, {.neutral_yaw = 0.0, .on_the_way = true});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[0].io.vacuum) << "it is already on the way to the row";
  EXPECT_TRUE(rows[0].X_WE.p.isApprox(before.X_WE.p + Vector3(0.5, -0.2, 0.1)));
  EXPECT_NEAR(turn_between(before, rows[0]), 0.6 * pi, 1e-12);
  EXPECT_EQ(rows[1].X_WE, goal.X_WE);
}

TEST(WithTurns, KeepsTheToolUnwoundOverAnyProgram) {
  Rng rng(5);
  for (const double neutral : {0.0, 1.0, -2.5}) {
    motion::Waypoint before = row_at(neutral);
    double accumulated = 0.0;
    for (int i = 0; i < 500; ++i) {
      const double yaw = neutral + rng.uniform(-0.99 * pi, 0.99 * pi);
      for (const motion::Waypoint& row : with_turns(before, {row_at(yaw, rng.uniform(-0.1, 0.1))}, {neutral})) {
        const double turn = turn_between(before, row);
        EXPECT_LT(std::abs(turn), 155.0 * pi / 180.0);
        accumulated += turn;
        before = row;
      }
      // Little tilts make the shorter way a little different from a turn about the vertical: not a whole one.
      const double wanted = std::remainder(yaw - neutral, 2.0 * pi);
      EXPECT_NEAR(std::remainder(*motion::yaw_of(before.X_WE.R) - neutral, 2.0 * pi), wanted, 0.02);
      EXPECT_LT(std::abs(accumulated), 4.0 + 1e-3 * i);
    }
  }
}

motion::Waypoint row_over(double x, double y, double z) {
  return motion::named_waypoint("Row", {pointing_down(0.0), Vector3(x, y, z)});
}

TEST(WithDetours, LeadsAroundTheBaseOnTheSideOfTheStraightWay) {
  const Vector3 p_WB(0.1, 0.0, 0.0);
  const auto rows = with_detours(row_over(0.5, -0.2, 0.3), {row_over(-0.4, -0.2, 0.2)}, p_WB, 0.3, 0.4);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(motion::name_of(rows[0]), "Row_around");
  EXPECT_TRUE(rows[0].X_WE.p.isApprox(Vector3(0.1, -0.4, 0.3), 1e-12));
  // Far enough, too short, and with the tool tilted: as they are.
  EXPECT_EQ(with_detours(row_over(0.5, -0.35, 0.3), {row_over(-0.4, -0.35, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
  EXPECT_EQ(with_detours(row_over(0.2, -0.2, 0.3), {row_over(0.0, -0.2, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
  motion::Waypoint tilted = row_over(-0.4, -0.2, 0.2);
  tilted.X_WE = {pointing_down(0.0, 1.2), tilted.X_WE.p};
  EXPECT_EQ(with_detours(row_over(0.5, -0.2, 0.3), {tilted}, p_WB, 0.3, 0.4).size(), 1u);
  // Straight over the axis there is no better side.
  EXPECT_EQ(with_detours(row_over(0.5, 0.0, 0.3), {row_over(-0.4, 0.0, 0.2)}, p_WB, 0.3, 0.4).size(), 1u);
}

}  // namespace
}  // namespace snug::skills
