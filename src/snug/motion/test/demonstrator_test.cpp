// Tests against the demonstrator's own programs: durations of its trajectories and of whole runs, without physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "snug/motion/program_csv.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

Program real_program(int sequence) {
  return load_program(waypoint_folder() / ("poses" + std::to_string(sequence) + "real.csv"));
}

/// The demonstrator waits at `home`, the last row, for its program to start.
double duration_of(int sequence, bool corrected, bool sampled_coast, const Tracking& tracking = LaggedTracking{}) {
  Program program = real_program(sequence);
  const Pose X_WE_home = program.waypoints.back().X_WE;
  if (corrected) program = apply_corrections(program, demonstrator_corrections(sequence));
  ControllerSettings settings = demonstrator_settings(sequence);
  settings.sampled_coast = sampled_coast;
  settings.tracking = tracking;
  return compute_duration(prepare(program, settings), X_WE_home);
}

struct Reported {
  int sequence;
  double report;     ///< s, the report's total
  double point;      ///< s, of a point model with corrections and sampled coast (interfaces 2.4)
  double plain;      ///< s, of the point model without
  double reference;  ///< s, sum of the LSPB durations
};

class DemonstratorSequence : public testing::TestWithParam<Reported> {};
INSTANTIATE_TEST_SUITE_P(Motion, DemonstratorSequence,
                         testing::Values(Reported{1, 248.0, 248.4, 246.0, 117.0},
                                         Reported{2, 232.0, 232.4, 230.0, 119.0},
                                         Reported{3, 292.0, 292.0, 290.0, 138.0}),
                         [](const auto& test) { return std::to_string(test.param.sequence); });

TEST_P(DemonstratorSequence, TakesAsLongAsReported) {
  SNUG_NEED_WAYPOINT_FILES();
  const Reported& reported = GetParam();
  const double duration = duration_of(reported.sequence, true, true);
  RecordProperty("duration_s", std::to_string(duration));
  EXPECT_NEAR(duration, reported.report, 0.04 * reported.report);  // required
  EXPECT_NEAR(duration, reported.point, 1.0);                      // the same model: one tick a row, rounded figures
}

TEST_P(DemonstratorSequence, IsAboutTwoSecondsShorterWithoutCorrectionsAndSampledCoast) {
  SNUG_NEED_WAYPOINT_FILES();
  const Reported& reported = GetParam();
  const double duration = duration_of(reported.sequence, false, false);
  RecordProperty("duration_s", std::to_string(duration));
  EXPECT_NEAR(duration, reported.plain, 1.0);
}

TEST_P(DemonstratorSequence, SpendsLessThanHalfOfItsTimeOnTheReferenceMotions) {
  SNUG_NEED_WAYPOINT_FILES();
  const Reported& reported = GetParam();
  const Program program = real_program(reported.sequence);
  const std::vector<NamedLimits> table = demonstrator_limits();
  Pose X_WE = program.waypoints.back().X_WE;
  double total = 0.0;
  double worst_jump = 0.0;
  for (std::size_t row = 0; row < program.waypoints.size(); ++row) {
    const LspbSegment segment(X_WE, program.waypoints[row].X_WE, find_limits(program, row, table));
    total += segment.duration();
    X_WE = segment.end();
    const LspbProfile sampled = segment.with_sampled_coast(0.008).translation();
    worst_jump = std::max(
        worst_jump, 0.5 * (sampled.peak_speed - sampled.coast_speed) * (sampled.duration - 2.0 * sampled.blend_time));
  }
  RecordProperty("trapezoids_s", std::to_string(total));
  RecordProperty("worst_jump_mm", std::to_string(1000.0 * worst_jump));
  EXPECT_NEAR(total, reported.reference, 1.1);  // the figures are rounded to seconds, the point model starts elsewhere
  EXPECT_NEAR(worst_jump, 0.0215, 0.001);       // interfaces 2.3: jumps of the reference up to 21-22 mm
  // Exact tracking adds the waits and half a tick a row.
  const double ideal = duration_of(reported.sequence, false, false, ExactTracking{});
  EXPECT_GT(ideal, total);
  EXPECT_LT(ideal, reported.plain - 60.0);
}

}  // namespace
}  // namespace snug::motion
