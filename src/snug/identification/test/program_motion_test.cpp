// motion_of: a run on a recording's own clock, between frames, behind its end.
#include "snug/identification/internal/program_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

model::SceneTask run_task() {
  model::SceneTask task;
  task.start.from = model::StartFrom::Scenario;
  task.tracked = {{"parcel", {}, {}, {}}};
  return task;
}

/// A box at 1 m/s along x that turns by 0.5 rad/s, frames of 8 ms, to `end`.
ProgramRun moving_run(double end) {
  ProgramRun run;
  run.tracks.resize(1);
  for (int k = 0; 0.008 * k <= end + 1e-9; ++k)
    run.tracks[0].add(0.008 * k, Pose{exp_rotation(Vector3(0.0, 0.0, 0.004 * k)), Vector3(0.008 * k, 0.0, 0.0)});
  run.until = end;
  run.end = std::numeric_limits<double>::infinity();
  return run;
}

RecordedMotion asked_at(std::vector<double> times) {
  RecordedMotion motion;
  motion.tracked.push_back({"parcel", std::vector<record::PoseSample>(times.size()), {}, {}});
  motion.times = std::move(times);
  return motion;
}

SimulatedMotion seen(const ProgramRun& run, const RecordedMotion& motion, const model::SceneTask& task,
                     const Eigen::VectorXd& own = {}) {
  return motion_of(run, motion, compared_samples(task, motion), OwnValues(task, 0, own));
}

TEST(ProgramMotion, IsOnALineBetweenFrames) {
  const RecordedMotion motion = asked_at({0.0, 0.003, 0.1234, 0.8});
  const SimulatedMotion simulated = seen(moving_run(1.0), motion, run_task());
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(simulated.bodies[0][k].p.x(), motion.times[k], 1e-12);
    EXPECT_NEAR(log_rotation(simulated.bodies[0][k].pose().R).z(), 0.5 * motion.times[k], 1e-12);
  }
  EXPECT_TRUE(std::isinf(simulated.end));
}

TEST(ProgramMotion, IsOnTheClockThatRecorded) {
  model::SceneTask task = run_task();
  task.own.delay = 0.1;
  task.own.clock_rate = 0.01;
  const RecordedMotion motion = asked_at({0.2, 0.5, 0.9});
  const SimulatedMotion simulated = seen(moving_run(1.0), motion, task, Eigen::Vector2d(0.05, 0.02));
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(simulated.bodies[0][k].p.x(), motion.times[k] - 0.05 - 0.02 * motion.times[k], 1e-12);
}

TEST(ProgramMotion, IsLostWhereTheRunDoesNotReach) {
  const SimulatedMotion simulated = seen(moving_run(0.4), asked_at({0.1, 0.39, 0.45, 2.0}), run_task());
  EXPECT_TRUE(record::is_tracked(simulated.bodies[0][1]));
  EXPECT_FALSE(record::is_tracked(simulated.bodies[0][2]));
  EXPECT_FALSE(record::is_tracked(simulated.bodies[0][3]));
}

TEST(ProgramMotion, SaysWhenARunBrokeOffOnTheRecordingsClock) {
  model::SceneTask task = run_task();
  task.own.delay = 0.1;
  ProgramRun run = moving_run(0.4);
  run.end = 0.4;
  EXPECT_NEAR(seen(run, asked_at({0.1}), task, Eigen::VectorXd::Constant(1, 0.03)).end, 0.43, 1e-12);
  run.failure = "the tool cannot get there";
  const SimulatedMotion simulated = seen(run, asked_at({0.1}), task);
  EXPECT_EQ(simulated.failure, run.failure);
  EXPECT_TRUE(simulated.bodies.empty());
}

TEST(ProgramMotion, OfAMeanThatReachesPastTheRunIsLost) {
  RecordedMotion motion = asked_at({0.2, 0.395});
  motion.period = 0.01;
  motion.tracked[0].averaged = {5, 5};
  const SimulatedMotion simulated = seen(moving_run(0.4), motion, run_task());
  EXPECT_NEAR(simulated.bodies[0][0].p.x(), 0.2, 1e-12);  // even motion: its mean is its middle
  EXPECT_FALSE(record::is_tracked(simulated.bodies[0][1]));
}

TEST(ProgramMotion, RunsALittleLongerThanWhatIsCompared) {
  model::SceneTask task = run_task();
  const RecordedMotion motion = asked_at({0.1, 0.2, 0.9});
  constexpr double kNever = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(end_of(task, motion, OwnValues(task, 0, {}), kNever), 1.0, 1e-12);
  EXPECT_NEAR(end_of(task, motion, OwnValues(task, 0, {}), 0.5), 0.6, 1e-12);
  task.own.delay = 0.1;
  // Of a recording that is late by 40 ms the run has to go 40 ms less.
  EXPECT_NEAR(end_of(task, motion, OwnValues(task, 0, Eigen::VectorXd::Constant(1, 0.04)), kNever), 0.96, 1e-12);
  task.simulation_time = 0.3;
  EXPECT_NEAR(end_of(task, motion, OwnValues(task, 0, {}), kNever), 0.3, 1e-12);
}

TEST(ProgramTrack, KeepsEachPoseThatDiffersInTheLastBit) {
  Track track;
  const Pose at{Matrix3::Identity(), Vector3(1.0, 0.0, 0.0)};
  const Pose next{Matrix3::Identity(), Vector3(std::nextafter(1.0, 2.0), 0.0, 0.0)};
  for (const Pose& pose : {at, at, at, next, at, at, at})
    track.add(0.1 * static_cast<double>(track.times.size()), pose);
  EXPECT_EQ(track.poses.size(), 5U);
}

TEST(ProgramTrack, KeepsWhenABoxIsNotThere) {
  Track track;
  for (int k = 0; k < 10; ++k) track.add(0.1 * k, k < 6 ? record::lost_pose() : record::PoseSample(Pose{}));
  ASSERT_EQ(track.times.size(), 4U);
  EXPECT_DOUBLE_EQ(track.times[1], 0.5);  // not there until then
  EXPECT_FALSE(record::is_tracked(track.poses[1]));
  EXPECT_DOUBLE_EQ(track.times[2], 0.6);
  EXPECT_DOUBLE_EQ(track.times[3], 0.9);
}

}  // namespace
}  // namespace snug::identification::internal
