// Both forms of the metrics against errors that were put in by hand.
#include "snug/validation/metrics.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/validation/internal/smoothing.hpp"

namespace snug::validation {
namespace {

using record::PoseSample;

/// The run itself as a measurement on the run's clock, each pose changed by `change(time, pose)`. A nanometre of noise
/// tells a body at rest from one that is not measured anew.
template <class Change>
Measurement measured_as(const SimulatedRun& run, Change change) {
  Measurement measurement;
  measurement.pose_times = run.times;
  measurement.bodies.resize(run.bodies.size());
  Rng rng = Rng(1).split("nanometres");
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    for (std::size_t i = 0; i < run.times.size(); ++i) {
      const PoseSample& X_WB = run.bodies[b][i];
      measurement.bodies[b].push_back(record::is_tracked(X_WB) ? change(run.times[i], X_WB) : X_WB);
      measurement.bodies[b].back().p.x() += 1e-9 * rng.normal();
    }
  }
  measurement.wrench_times = run.times;
  measurement.wrenches = run.wrench;
  return measurement;
}

const Window kWindow = {"BOX013", 2.0, 18.0};

TEST(Metrics, NothingIsWrongWithTheRunItself) {
  const SimulatedRun run = test::example_run();
  const Errors errors =
      compare(run, measured_as(run, [](double, const PoseSample& X) { return X; }), kWindow, Form::Clean);
  EXPECT_LT(errors.rms_position, 1e-8);
  EXPECT_LT(errors.rms_rotation, 1e-7);
  EXPECT_LT(errors.rest_position, 1e-8);
  EXPECT_LT(errors.rms_force, 1e-9);
  EXPECT_EQ(errors.tracked, 1.0);
}

TEST(Metrics, AConstantErrorComesOutInBothFormsOfAllMeans) {
  const SimulatedRun run = test::example_run();
  Measurement measurement = measured_as(run, [](double, const PoseSample& X) {
    return PoseSample(Pose{X.pose().R, X.p + Vector3(3e-3, -4e-3, 0.0)});
  });
  for (Wrench& wrench : measurement.wrenches) wrench.force += Vector3(0.0, 6.0, 8.0);
  const Errors clean = compare(run, measurement, kWindow, Form::Clean);
  EXPECT_NEAR(clean.rms_position, 5e-3, 1e-8);
  EXPECT_NEAR(clean.rest_position, 5e-3, 1e-8);
  EXPECT_NEAR(clean.rms_force, 10.0, 1e-9);
  const Errors report = compare(run, measurement, kWindow, Form::Report);
  EXPECT_NEAR(report.rest_position, 5e-3, 1e-4);
  EXPECT_NEAR(report.rms_force, 10.0, 0.2);  // its filter rounds the steps of the weight
}

TEST(Metrics, CleanRotationIsTheGeodesicAngleAlsoBeyondHalfATurn) {
  const SimulatedRun run = test::example_run();
  const Window window = {"BOX030", 40.0, 43.0};  // at rest, turned by -3.1 rad
  const Vector3 turn(0.0, 0.0, -0.1);            // across pi
  const Measurement measurement = measured_as(run, [&](double, const PoseSample& X) {
    return PoseSample(Pose{X.pose().R * exp_rotation(turn), X.p});
  });
  const Errors clean = compare(run, measurement, window, Form::Clean);
  EXPECT_NEAR(clean.rms_rotation, 0.1, 1e-7);
  EXPECT_NEAR(clean.rest_rotation, 0.1, 1e-7);
  const Errors report = compare(run, measurement, window, Form::Report);
  EXPECT_NEAR(report.rms_rotation, 0.1, 1e-6);  // one axis: vectors differ by the angle once the jump is taken out
}

TEST(Metrics, DifferenceOfRotationVectorsIsNotTheAngleForTwoAxes) {
  // BOX013 rests at a rotation vector of 1.6 rad; turned about another axis, vectors differ by more than the angle.
  const SimulatedRun run = test::example_run();
  const Window window = {"BOX013", 17.0, 19.5};
  const Measurement measurement = measured_as(run, [&](double, const PoseSample& X) {
    return PoseSample(Pose{X.pose().R * exp_rotation(Vector3(0.1, 0.0, 0.0)), X.p});
  });
  const Errors clean = compare(run, measurement, window, Form::Clean);
  const Errors report = compare(run, measurement, window, Form::Report);
  EXPECT_NEAR(clean.rms_rotation, 0.1, 1e-7);
  const Matrix3 R = run.bodies[0].back().pose().R;
  const double expected = (log_rotation(R * exp_rotation(Vector3(0.1, 0.0, 0.0))) - log_rotation(R)).norm();
  EXPECT_GT(std::abs(expected - 0.1), 0.01);
  EXPECT_NEAR(report.rms_rotation, expected, 1e-6);
}

TEST(Metrics, OnlyTheReportsFormDropsLargeErrors) {
  const SimulatedRun run = test::example_run();
  const Measurement measurement = measured_as(run, [](double time, const PoseSample& X) {
    const bool is_off = time > 9.0 && time < 10.0;  // a sixteenth of the window, 200 mm off
    return PoseSample(Pose{X.pose().R, X.p + Vector3(is_off ? 0.2 : 0.0, 0.0, 0.0)});
  });
  const Errors clean = compare(run, measurement, kWindow, Form::Clean);
  EXPECT_NEAR(clean.rms_position, 0.2 / 4.0, 1e-3);
  EXPECT_EQ(clean.dropped, 0.0);
  const Errors report = compare(run, measurement, kWindow, Form::Report);
  EXPECT_LT(report.rms_position, 0.03);
}

TEST(Metrics, LostMarkersAreCountedAndHalfIsTheLeast) {
  const SimulatedRun run = test::example_run();
  const auto lost_between = [&](double from, double to) {
    return measured_as(
        run, [=](double time, const PoseSample& X) { return time > from && time < to ? record::lost_pose() : X; });
  };
  const Errors some = compare(run, lost_between(4.0, 8.0), kWindow, Form::Clean);
  EXPECT_NEAR(some.tracked, 0.75, 0.005);
  EXPECT_LT(some.rms_position, 1e-8);
  const Errors end = compare(run, lost_between(17.0, 20.0), kWindow, Form::Clean);
  EXPECT_TRUE(std::isnan(end.rest_position));
  EXPECT_FALSE(std::isnan(end.rms_position));
  for (const Form form : {Form::Clean, Form::Report}) {
    const Errors most = compare(run, lost_between(3.0, 14.0), kWindow, form);
    EXPECT_TRUE(std::isnan(most.rms_position));
    EXPECT_NEAR(most.tracked, 5.0 / 16.0, 0.005);
  }
}

TEST(Metrics, RestIsTheMeanOfTheLastHalfSecondAndTheLastSample) {
  const SimulatedRun run = test::example_run();
  const Measurement measurement = measured_as(run, [](double time, const PoseSample& X) {
    return PoseSample(Pose{X.pose().R, X.p + Vector3(0.0, 0.0, time > 17.75 ? 2e-3 : 0.0)});
  });
  EXPECT_NEAR(compare(run, measurement, kWindow, Form::Clean).rest_position, 1e-3, 5e-5);
}

TEST(Metrics, BodiesThatWereNotMeasuredHaveNoErrors) {
  const SimulatedRun run = test::example_run();
  Measurement measurement = measured_as(run, [](double, const PoseSample& X) { return X; });
  measurement.bodies[0].clear();
  const Errors errors = compare(run, measurement, kWindow, Form::Clean);
  EXPECT_TRUE(std::isnan(errors.rms_position));
  EXPECT_FALSE(std::isnan(errors.rms_force));
}

TEST(Smoothing, KeepsParabolasAndAveragesNoise) {
  std::vector<double> parabola, noise;
  Rng rng = Rng(2).split("smoothing");
  for (int i = 0; i < 400; ++i) {
    parabola.push_back(3.0 - 0.2 * i + 0.01 * i * i);
    noise.push_back(rng.normal());
  }
  const std::vector<double> same = internal::smooth(parabola), quiet = internal::smooth(noise);
  double sum = 0.0;
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_NEAR(same[i], parabola[i], 1e-9);
    sum += quiet[i] * quiet[i] / 400.0;
  }
  // The middle weight of the filter, 9/(4 * 51), is the variance that it leaves; fewer samples at the ends leave more.
  EXPECT_NEAR(std::sqrt(sum), std::sqrt(9.0 / (4.0 * 51.0)), 0.06);
}

TEST(Smoothing, GapsAreFilledWithoutOvershoot) {
  std::vector<double> times, values;
  for (int i = 0; i < 100; ++i) {
    times.push_back(0.01 * i);
    values.push_back(i < 40 ? 0.0 : 1.0);
  }
  for (std::size_t i = 35; i < 45; ++i) values[i] = std::numeric_limits<double>::quiet_NaN();
  values[0] = values[99] = std::numeric_limits<double>::quiet_NaN();
  internal::fill_gaps(times, values);
  for (std::size_t i = 1; i < 99; ++i) {
    EXPECT_GE(values[i], 0.0);
    EXPECT_LE(values[i], 1.0);
    EXPECT_GE(values[i], i > 1 ? values[i - 1] : 0.0);
  }
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_TRUE(std::isnan(values[99]));
}

TEST(Smoothing, SingleSpikesAreOutliers) {
  std::vector<double> times, values;
  Rng rng = Rng(3).split("spikes");
  for (int i = 0; i < 2000; ++i) {
    times.push_back(i / 360.0);
    values.push_back(0.1 * rng.normal() + (i == 1000 ? 5.0 : 0.0));
  }
  const std::vector<bool> found = internal::find_outliers(times, values, 3.0);
  EXPECT_TRUE(found[1000]);
  // Three standard deviations: 0.27 % of normal noise.
  EXPECT_LT(std::count(found.begin(), found.end(), true), 20);
}

}  // namespace
}  // namespace snug::validation
