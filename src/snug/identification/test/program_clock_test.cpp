// Program clock: found on the way to the first pick, whatever the tool's timing is later.
#include "snug/identification/internal/program_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kStart = 250.0374;  // s, of the robot's clock
constexpr double kPick = 2.0;        // s

Pose tool_at(double t) {
  return {Matrix3::Identity(), Vector3(0.3 * std::cos(0.9 * t), 0.3 * std::sin(0.9 * t), 0.2 + 0.02 * t)};
}

validation::SimulatedRun circle() {
  validation::SimulatedRun run;
  for (int k = 0; k < 1000; ++k) {
    run.times.push_back(0.008 * k);
    run.tool.emplace_back(tool_at(run.times.back()));
  }
  return run;
}

double to_run(double time) { return time - kStart; }

/// The same tool, `late` seconds late after the pick, with the noise of a robot's log.
record::ArchiveRecording log_of(double late) {
  Rng rng = Rng(5).split("log");
  record::ArchiveRecording recording;
  recording.robot.names = {"actual_digital_output_bits"};
  recording.robot.columns.resize(1);
  for (int k = 0; k < 900; ++k) {
    const double t = 0.003 + 0.008 * k;
    Pose X_WE = tool_at(t > kPick ? std::max(kPick, t - late) : t);
    X_WE.p += 3e-5 * Vector3(rng.normal(), rng.normal(), rng.normal());
    recording.robot.times.push_back(kStart + t);
    recording.robot.tool.emplace_back(X_WE);
    recording.robot.columns[0].push_back(t > kPick ? 1.0 : 0.0);
  }
  return recording;
}

TEST(ProgramClock, IsFoundOnTheWayToTheFirstPick) {
  for (const double late : {0.0, 0.04, 0.09}) {
    SCOPED_TRACE(late);
    for (const double guess : {kStart - 0.1, kStart, kStart + 0.07}) {
      const std::optional<double> start = find_program_start(circle(), log_of(late), guess);
      ASSERT_TRUE(start);
      // 3e-5 m on each of 225 samples at 0.27 m/s: 7 us; ten of these, and lines between frames.
      EXPECT_NEAR(*start, kStart, 1e-4);
    }
    EXPECT_LT(find_path_distance(circle(), log_of(late), to_run, 0.1), 1e-3) << "half a tick's way";
    EXPECT_GE(find_path_distance(circle(), log_of(late), to_run, 0.0), 0.2 * late);
  }
}

TEST(ProgramClock, IsNotFoundWhereNothingTellsIt) {
  record::ArchiveRecording recording = log_of(0.0);
  std::ranges::fill(recording.robot.columns[0], 0.0);
  EXPECT_FALSE(find_program_start(circle(), recording, kStart)) << "nothing is picked";
  recording = log_of(0.0);
  for (std::size_t k = 0; recording.robot.columns[0][k] < 0.5; ++k) recording.robot.tool[k] = recording.robot.tool[0];
  EXPECT_FALSE(find_program_start(circle(), recording, kStart)) << "the tool stands until then";
  for (record::PoseSample& X_WE : recording.robot.tool) X_WE.p.z() += 0.01;
  EXPECT_GT(find_path_distance(circle(), recording, to_run, 0.1), 0.009) << "another way";
}

}  // namespace
}  // namespace snug::identification::internal
