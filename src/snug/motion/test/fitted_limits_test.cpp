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
    waypoint.p_WE.x() = x;
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
  const LspbSegment segment(Pose(), plan.program.waypoints[0].X_WE(), fitted[0]);
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

}  // namespace
}  // namespace snug::motion
