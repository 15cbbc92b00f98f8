// fit_limits: moves that take as long as the simulated ones, none faster than planned.
#include "snug/motion/fitted_limits.hpp"
#include "snug/motion/waypoint_name.hpp"

#include <gtest/gtest.h>

namespace snug::motion {
namespace {

/// Moves along x by these lengths, each to 1 mm.
PreparedProgram make_plan(const std::vector<double>& lengths, double precision) {
  Program program;
  program.name = "moves";
  double x = 0.0;
  for (const double length : lengths) {
    Waypoint waypoint = parse_waypoint_name("move");
    x += length;
    waypoint.X_WE.p.x() = x;
    program.waypoints.push_back(waypoint);
  }
  ControllerSettings settings;
  settings.limits = {{"move", {precision, 3.0, 0.5, 1.5, 1.5}}};
  return prepare(program, settings);
}

TEST(FitLimits, MakeAMoveTakeAsLongAsTheToolThatLagsBehind) {
  const PreparedProgram plan = make_plan({0.4}, 0.001);
  const std::vector<MotionLimits> fitted = fit_limits(plan, Pose());
  const double simulated = compute_duration(plan, Pose());
  const LspbSegment segment(Pose(), plan.program.waypoints[0].X_WE, fitted[0]);
  EXPECT_NEAR(segment.duration(), simulated, 2.0 * plan.settings.tick);  // when a tick begins and ends it
  EXPECT_LT(fitted[0].max_acceleration, 0.5 * plan.row_limits[0].max_acceleration);
  EXPECT_LT(fitted[0].max_speed, plan.row_limits[0].max_speed);
}

TEST(FitLimits, AreNeverAboveThoseOfThePlan) {
  for (const double precision : {0.001, 0.005, 0.05, 0.2}) {
    const PreparedProgram plan = make_plan({0.4, 0.1, 0.02, 0.7, 0.001}, precision);
    const std::vector<MotionLimits> fitted = fit_limits(plan, Pose());
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      EXPECT_LE(fitted[i].max_acceleration, plan.row_limits[i].max_acceleration);
      EXPECT_LE(fitted[i].max_speed, plan.row_limits[i].max_speed);
      EXPECT_GT(fitted[i].max_acceleration, 0.0);
      EXPECT_GT(fitted[i].max_speed, 0.0);
      EXPECT_EQ(fitted[i].precision, plan.row_limits[i].precision);
    }
  }
}

TEST(FitLimits, LeaveARowThatIsPassedAtOnceItsOwnLimits) {
  // 25 mm in a row to 50 mm: the tool that lags behind aims at the next row a tick later, having hardly moved.
  const PreparedProgram plan = make_plan({0.025, 0.3}, 0.05);
  const std::vector<MotionLimits> fitted = fit_limits(plan, Pose());
  EXPECT_EQ(fitted[0].max_speed, plan.row_limits[0].max_speed);
  EXPECT_EQ(fitted[0].max_acceleration, plan.row_limits[0].max_acceleration);
}

TEST(FitLimits, MakeNoRowSlowerThanItWasSimulatedAndThanItsOwnLimitsAllow) {
  for (const double precision : {0.001, 0.005, 0.02, 0.05, 0.2}) {
    for (const double length : {0.003, 0.01, 0.021, 0.025, 0.049, 0.06, 0.3}) {
      const PreparedProgram plan = make_plan({length, 0.2}, precision);
      const std::vector<MotionLimits> fitted = fit_limits(plan, Pose());
      Pose X_WE;
      for (std::size_t i = 0; i < fitted.size(); ++i) {
        const Pose& goal = plan.X_WE[i];
        const double own = LspbSegment(X_WE, goal, plan.row_limits[i]).duration();
        // A row cannot have been simulated for longer than the whole program.
        const double most = std::max(own, compute_duration(plan, Pose()));
        EXPECT_LE(LspbSegment(X_WE, goal, fitted[i]).duration(), most * (1.0 + 1e-9)) << precision << " " << length;
        X_WE = goal;
      }
    }
  }
}

}  // namespace
}  // namespace snug::motion
