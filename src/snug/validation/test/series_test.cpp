// Series and errors of a comparison: continuous, the same in any world and at any time, means where the header says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/metrics.hpp"

namespace snug::validation {
namespace {

using record::PoseSample;

/// A box that turns about an axis at an even rate, and a measurement of it that is off by a turn and a shift.
struct Turning {
  explicit Turning(double rate, const Pose& off = {}) {
    run.header.bodies.push_back({"A", "B1", record::BodyKind::Dynamic, 1.0, {}, {}});
    run.bodies.resize(1);
    measured.bodies.resize(1);
    for (int i = 0; i <= 500; ++i) {
      const double t = 0.008 * i;
      const Pose X_WB{exp_rotation(Vector3(0.0, 0.0, rate * t)), Vector3(std::sin(t), 0.2 * t, 0.1)};
      run.times.push_back(t);
      run.bodies[0].emplace_back(X_WB);
      run.wrench.push_back({Vector3(std::sin(3.0 * t), 0.0, -8.0), Vector3(0.0, 0.1 * t, 0.0)});
      run.attached.push_back(-1);
      measured.pose_times.push_back(t);
      measured.bodies[0].emplace_back(Pose{X_WB.R * off.R, X_WB.p + off.p});
    }
    // Forces at four times the rate of frames, none half a frame from an instant: rounding would tell whose it is.
    for (int i = 0; i <= 2000; ++i) {
      const double t = 0.0007 + 0.002 * i;
      measured.wrench_times.push_back(t);
      measured.wrenches.push_back({Vector3(std::sin(3.0 * t), 0.0, -8.0), Vector3(0.0, 0.1 * t, 0.0)});
    }
  }
  SimulatedRun run;
  Measurement measured;
  Window window{"A", 0.5, 3.5};
};

TEST(PoseSeries, GoesThroughHalfTurnsWithoutAJump) {
  // Once and a half around: rotation vectors grow beyond pi instead of jumping to the other side.
  const Turning turning(2.4, {exp_rotation(Vector3(0.0, 0.0, 0.3)), Vector3::Zero()});
  const PoseSeries series = pose_series(turning.run, turning.measured, turning.window);
  ASSERT_GT(series.times.size(), 300U);
  for (std::size_t i = 1; i < series.times.size(); ++i) {
    EXPECT_NEAR((series.w_simulated[i] - series.w_simulated[i - 1]).norm(), 2.4 * 0.008, 1e-9) << series.times[i];
    EXPECT_NEAR((series.w_measured[i] - series.w_simulated[i]).norm(), 0.3, 1e-9);
    EXPECT_NEAR(series.rotation_error[i], 0.3, 1e-9);
  }
}

TEST(PoseSeries, HoldsTheInstantsOfTheWindowBothEndsCounted) {
  const Turning turning(0.5);
  const PoseSeries series =
      pose_series(turning.run, turning.measured, {"A", turning.run.times[100], turning.run.times[200]});
  ASSERT_EQ(series.times.size(), 101U);
  EXPECT_EQ(series.times.front(), turning.run.times[100]);
  EXPECT_EQ(series.times.back(), turning.run.times[200]);
  EXPECT_TRUE(pose_series(turning.run, turning.measured, {"A", 100.0, 200.0}).times.empty());
}

TEST(PoseSeries, LeavesOutInstantsAtWhichTheBoxIsNotThereAndMarksLostOnes) {
  Turning turning(0.5);
  for (std::size_t i = 100; i < 150; ++i) turning.run.bodies[0][i] = record::lost_pose();
  for (std::size_t i = 200; i < 230; ++i) turning.measured.bodies[0][i] = record::lost_pose();
  const PoseSeries series = pose_series(turning.run, turning.measured, {"A", 0.0, 4.0});
  EXPECT_EQ(series.times.size(), 501U - 50U);
  EXPECT_EQ(std::count_if(series.position_error.begin(), series.position_error.end(),
                          [](double error) { return std::isnan(error); }),
            30);
  for (std::size_t i = 0; i < series.times.size(); ++i)
    EXPECT_EQ(std::isnan(series.position_error[i]), std::isnan(series.p_measured[i].x())) << i;
}

TEST(Compare, IsTheSameInAnyWorldThatBothAreSeenFrom) {
  const Pose off{exp_rotation(Vector3(0.02, -0.03, 0.05)), Vector3(0.003, -0.002, 0.001)};
  Turning here(0.7, off), there(0.7, off);
  const Pose X{exp_rotation(Vector3(0.5, -1.0, 0.3)), Vector3(2.0, -1.0, 0.5)};
  for (PoseSample& pose : there.run.bodies[0]) pose = X * pose.pose();
  for (PoseSample& pose : there.measured.bodies[0]) pose = X * pose.pose();
  const Errors a = compare(here.run, here.measured, here.window, Form::Clean),
               b = compare(there.run, there.measured, there.window, Form::Clean);
  EXPECT_NEAR(a.rms_position, b.rms_position, 1e-12);
  EXPECT_NEAR(a.rms_rotation, b.rms_rotation, 1e-9);
  EXPECT_NEAR(a.rest_position, b.rest_position, 1e-12);
  EXPECT_NEAR(a.rest_rotation, b.rest_rotation, 1e-9);
  EXPECT_NEAR(a.rms_position, off.p.norm(), 1e-12);
  EXPECT_NEAR(a.rms_rotation, log_rotation(off.R).norm(), 1e-9);
}

TEST(Compare, IsTheSameAtAnyTimeThatBothAreSeenAt) {
  const Turning here(0.7, {Matrix3::Identity(), Vector3(0.003, 0.0, 0.0)});
  Turning later = here;
  for (auto* times : {&later.run.times, &later.measured.pose_times, &later.measured.wrench_times})
    for (double& time : *times) time += 64.0;  // exact in binary: the same instants are compared
  later.window.start += 64.0;
  later.window.end += 64.0;
  for (const Form form : {Form::Clean, Form::Report}) {
    const Errors a = compare(here.run, here.measured, here.window, form),
                 b = compare(later.run, later.measured, later.window, form);
    EXPECT_NEAR(a.rms_position, b.rms_position, 1e-9);
    EXPECT_NEAR(a.rms_force, b.rms_force, 1e-6);
    EXPECT_NEAR(a.tracked, b.tracked, 0.01);
  }
}

TEST(Compare, GrowsWithTheSizeOfTheErrorAndNotWithItsSign) {
  const auto error_of = [](double size) {
    const Turning turning(0.4, {exp_rotation(Vector3(0.0, size, 0.0)), Vector3(0.1 * size, 0.0, 0.0)});
    return compare(turning.run, turning.measured, turning.window, Form::Clean);
  };
  const Errors one = error_of(0.01), two = error_of(0.02), minus = error_of(-0.01);
  EXPECT_NEAR(two.rms_position / one.rms_position, 2.0, 1e-9);
  EXPECT_NEAR(two.rms_rotation / one.rms_rotation, 2.0, 1e-6);
  EXPECT_NEAR(minus.rms_position, one.rms_position, 1e-12);
}

TEST(WrenchSeries, IsTheMeanOfWhatWasMeasuredAroundEachInstant) {
  // Noise of the sensor alone: the mean of four samples has half of it.
  Turning turning(0.4);
  Rng rng = Rng(5).split("wrench noise");
  for (Wrench& wrench : turning.measured.wrenches) wrench.force.x() += 0.4 * rng.normal();
  const Errors errors = compare(turning.run, turning.measured, turning.window, Form::Clean);
  EXPECT_NEAR(errors.rms_force, 0.2, 0.03);
  const WrenchSeries series = wrench_series(turning.run, turning.measured, turning.window);
  ASSERT_EQ(series.times.size(), series.force_error.size());
  EXPECT_EQ(series.times.size(), 375U);  // 3 s of 8 ms, less than a frame at either end
  // Their mean is 0.3 ms aside, at 0.1 Nm/s.
  for (const double torque : series.torque_error) EXPECT_NEAR(torque, 3e-5, 1e-9);
}

TEST(WrenchSeries, LeavesOutInstantsWithoutASample) {
  Turning turning(0.4);
  std::erase_if(turning.measured.wrench_times, [](double t) { return t > 1.0 && t < 2.0; });
  turning.measured.wrenches.resize(turning.measured.wrench_times.size());
  const WrenchSeries series = wrench_series(turning.run, turning.measured, turning.window);
  for (const double time : series.times) EXPECT_FALSE(time > 1.01 && time < 1.99) << time;
}

TEST(Compare, OfABoxThatRestsIsTheSameInBothForms) {
  Turning still(0.0, {exp_rotation(Vector3(0.0, 0.0, 0.02)), Vector3(0.002, 0.0, 0.001)});
  Rng rng = Rng(6).split("nanometres");
  for (std::size_t i = 0; i < still.run.times.size(); ++i) {
    still.run.bodies[0][i] = PoseSample(Pose{});
    // What is the same to the last bit was not measured anew: the report's form would leave it out.
    still.measured.bodies[0][i] =
        Pose{exp_rotation(Vector3(0.0, 0.0, 0.02)), Vector3(0.002 + 1e-9 * rng.normal(), 0.0, 0.001)};
  }
  const Errors clean = compare(still.run, still.measured, still.window, Form::Clean),
               report = compare(still.run, still.measured, still.window, Form::Report);
  EXPECT_NEAR(clean.rms_position, std::hypot(0.002, 0.001), 1e-8);
  EXPECT_NEAR(report.rms_position, clean.rms_position, 1e-7);
  EXPECT_NEAR(report.rms_rotation, 0.02, 1e-7);
  EXPECT_NEAR(clean.rms_rotation, 0.02, 1e-7);
  EXPECT_EQ(report.dropped, 0.0);
}

}  // namespace
}  // namespace snug::validation
