// A virtual experiment: ideal sensors give the run back, noisy ones the statistics they state.
#include "snug/validation/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/validation/measurement.hpp"

namespace snug::validation {
namespace {

using record::BodyTrack;
using record::is_tracked;

const BodyTrack& track(const record::ArchiveRecording& recording, std::string_view name) {
  for (const BodyTrack& body : recording.motion_capture.bodies)
    if (body.name == name) return body;
  ADD_FAILURE() << "no " << name;
  return recording.motion_capture.bodies.front();
}

/// Equal to the last bit, lost at the same instants.
bool are_same(const std::vector<record::PoseSample>& a, const std::vector<record::PoseSample>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x == y || (!is_tracked(x) && !is_tracked(y)); });
}

TEST(Measure, IdealSensorsSeeTheRunInTheirFrame) {
  const SimulatedRun run = test::example_run();
  const VirtualMeasurement measured = measure(run, {}, {});
  const record::MotionCaptureLog& mocap = measured.recording.motion_capture;
  ASSERT_NEAR(static_cast<double>(mocap.times.size()), 44.0 * 360.0 + 1.0, 1.0);
  const BodyTrack& box = track(measured.recording, "Box013");
  for (std::size_t i = 0; i < mocap.times.size(); i += 45) {  // every eighth of a second, which is a frame of the run
    SCOPED_TRACE(i);
    const auto frame = static_cast<std::size_t>(std::lround(mocap.times[i] / 0.008));
    if (std::abs(run.times[frame] - mocap.times[i]) > 1e-9) continue;
    const Pose X_WB = measured.truth.X_MW.inverse() * box.poses[i].pose();
    EXPECT_LT((X_WB.p - run.bodies[0][frame].p).norm(), 1e-9);
    EXPECT_LT(angle_between(X_WB.R, run.bodies[0][frame].pose().R), 1e-7);
  }
  EXPECT_FALSE(is_tracked(track(measured.recording, "Box014").poses[360]));  // it comes at 20 s
  const record::WrenchLog& forces = measured.recording.force_torque;
  ASSERT_NEAR(static_cast<double>(forces.times.size()), 44.0 * 500.0 + 1.0, 1.0);
  for (std::size_t i = 0; i < forces.times.size(); i += 4) {  // 8 ms
    const std::size_t frame = i / 4;
    EXPECT_LT((forces.wrenches[i].force - run.wrench[frame].force).norm(), 1e-9);
  }
  EXPECT_NEAR(forces.accelerations[100].norm(), 9.81, 1e-9);
}

TEST(Measure, BaseIsWhereMotionCaptureSeesTheWorld) {
  const VirtualMeasurement measured = measure(test::example_run(), {}, {});
  const Pose X_MW = track(measured.recording, kBaseBody).poses[10].pose();
  EXPECT_LT((X_MW.p - measured.truth.X_MW.p).norm(), 1e-12);
}

TEST(Align, SaysHowWellThePoseOfTheBaseIsKnown) {
  model::Sensors sensors;
  sensors.motion_capture.position_noise = 1e-3;
  sensors.motion_capture.rotation_noise = 2e-3;
  const SimulatedRun run = test::example_run();
  const VirtualMeasurement measured = measure(run, sensors, {});
  const Measurement aligned = align(run, measured.recording, {}, "test");
  const double root = std::sqrt(static_cast<double>(measured.recording.motion_capture.times.size()));
  EXPECT_NEAR(aligned.base_position_error, 1e-3 / root, 0.02e-3 / root);  // scatter of 47 000 numbers: 0.3 %
  EXPECT_NEAR(aligned.base_rotation_error, 2e-3 / root, 0.04e-3 / root);
  record::ArchiveRecording without = measured.recording;
  std::erase_if(without.motion_capture.bodies, [](const BodyTrack& body) { return body.name == kBaseBody; });
  EXPECT_EQ(align(run, without, {}, "test").base_position_error, 0.0);
}

TEST(Measure, NoiseHasTheDeviationThatTheSensorsState) {
  model::Sensors sensors;
  sensors.motion_capture.position_noise = 2e-3;
  sensors.motion_capture.rotation_noise = 0.01;
  sensors.force_torque.force_noise = 0.5;
  const SimulatedRun run = test::example_run();
  const record::ArchiveRecording noisy = measure(run, sensors, {}).recording;
  const record::ArchiveRecording exact = measure(run, {}, {}).recording;
  double position = 0.0, rotation = 0.0, force = 0.0, count = 0.0;
  const auto &a = track(noisy, kBaseBody).poses, &b = track(exact, kBaseBody).poses;
  for (std::size_t i = 0; i < a.size(); ++i, count += 1.0) {
    position += (a[i].p - b[i].p).squaredNorm() / 3.0;
    rotation += std::pow(angle_between(a[i].pose().R, b[i].pose().R), 2) / 3.0;
  }
  // 15841 samples of three coordinates: 0.4 % of a standard deviation is one standard error of it.
  EXPECT_NEAR(std::sqrt(position / count), 2e-3, 4e-5);
  EXPECT_NEAR(std::sqrt(rotation / count), 0.01, 2e-4);
  for (std::size_t i = 0; i < noisy.force_torque.times.size(); ++i)
    force += (noisy.force_torque.wrenches[i].force - exact.force_torque.wrenches[i].force).squaredNorm() / 3.0;
  EXPECT_NEAR(std::sqrt(force / static_cast<double>(noisy.force_torque.times.size())), 0.5, 0.01);
}

TEST(Measure, ClocksBiasAndLossesAreThoseOfTheTruth) {
  const SimulatedRun run = test::example_run();
  const model::Sensors sensors =
      model::load_sensors(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/sensors/demonstrator.yaml");
  MeasureOptions options;
  options.seed = 3;
  const VirtualMeasurement measured = measure(run, sensors, options);
  EXPECT_NEAR(measured.recording.motion_capture.times.front(), measured.truth.motion_capture.offset, 1e-12);
  EXPECT_LE(std::abs(measured.truth.motion_capture.offset), 2.0);
  EXPECT_NE(measured.truth.motion_capture.offset, measured.truth.force_torque.offset);
  Vector3 mean = Vector3::Zero();
  for (std::size_t i = 0; i < 500; ++i) mean += measured.recording.force_torque.wrenches[i].force / 500.0;
  EXPECT_LT((mean - measured.truth.bias.force).norm(), 0.15);  // 0.3 / sqrt(500) and a second of drift
}

TEST(Measure, MarkersAreLostDeepInTheContainerAndOnlyThere) {
  SimulatedRun run = test::example_run();
  model::Sensors sensors;
  sensors.motion_capture.lost_probability = 1.0;
  sensors.motion_capture.lost_depth = 0.02;
  const VirtualMeasurement measured = measure(run, sensors, {});
  EXPECT_EQ(measured.truth.lost_bodies, (std::vector<std::string>{"Box013", "Box014", "Box030"}));
  const auto& poses = track(measured.recording, "Box013").poses;
  EXPECT_TRUE(is_tracked(poses[360 * 10]));   // on the bench
  EXPECT_FALSE(is_tracked(poses[360 * 20]));  // in the container
  sensors.motion_capture.lost_depth = 0.24;   // deeper than any box is
  EXPECT_TRUE(is_tracked(track(measure(run, sensors, {}).recording, "Box013").poses[360 * 20]));
}

TEST(Measure, LostMarkersAreHeldWhereSensorsDoSo) {
  model::Sensors sensors;
  sensors.motion_capture.lost_probability = 1.0;
  sensors.motion_capture.when_lost = model::WhenLost::Held;
  const auto poses = track(measure(test::example_run(), sensors, {}).recording, "Box013").poses;
  EXPECT_TRUE(poses[360 * 20] == poses[360 * 21]);
}

TEST(Measure, RepetitionsDifferAndSeedsRepeat) {
  const SimulatedRun run = test::example_run();
  model::Sensors sensors;
  sensors.motion_capture.position_noise = 1e-4;
  sensors.motion_capture.position_error = 1e-3;
  MeasureOptions first, second;
  second.repetition = 2;
  const record::ArchiveRecording a = measure(run, sensors, first).recording,
                                 b = measure(run, sensors, second).recording;
  const record::ArchiveRecording again = measure(run, sensors, first).recording;
  EXPECT_TRUE(are_same(track(a, "Box014").poses, track(again, "Box014").poses));
  EXPECT_FALSE(are_same(track(a, "Box014").poses, track(b, "Box014").poses));
  // How a body's frame was set stays with the body.
  EXPECT_LT((track(a, "Box013").poses[0].p - track(b, "Box013").poses[0].p).norm(), 8e-4);
  EXPECT_EQ(a.name, "Rec_20000101T000000Z");
  EXPECT_EQ(b.name, "Rec_20000101T002000Z");
  second.date = "20231231T235000Z";
  EXPECT_EQ(measure(run, sensors, second).recording.name, "Rec_20240101T001000Z");
}

TEST(Measure, DatesOfAnotherFormAreRefused) {
  for (const char* date :
       {"", "2023", "20231301T000000Z", "20230101T250000Z", "20230101T000000", "20230101T000000Zx"}) {
    MeasureOptions options;
    options.date = date;
    EXPECT_THROW((void)measure(test::example_run(), {}, options), InputError) << date;
  }
}

TEST(Measure, AnotherBodyChangesNothingForTheRest) {
  SimulatedRun run = test::example_run();
  model::Sensors sensors;
  sensors.motion_capture.position_noise = 1e-4;
  const auto before = track(measure(run, sensors, {}).recording, "Box030").poses;
  run.header.bodies.push_back(run.header.bodies[0]);
  run.header.bodies.back().name = "BOX099";
  run.bodies.push_back(run.bodies[0]);
  EXPECT_TRUE(are_same(track(measure(run, sensors, {}).recording, "Box030").poses, before));
}

TEST(MeasureTruth, HasClocksBiasAndFrameInItsJson) {
  MeasureTruth truth;
  truth.motion_capture = {.offset = 0.5, .rate = 2e-5};
  truth.bias.torque = Vector3(0.0, 0.0, 0.1);
  truth.lost_bodies = {"BOX001"};
  const auto json = nlohmann::json::parse(format_json(truth, "Rec"));
  EXPECT_EQ(json.at("name"), "Rec");
  EXPECT_DOUBLE_EQ(json.at("clocks").at("motion_capture").at("rate_ppm").get<double>(), 20.0);
  EXPECT_EQ(json.at("bias").at("torque_Nm").at(2), 0.1);
  EXPECT_EQ(json.at("X_MW").at("quat_wxyz").at(0), 1.0);
  EXPECT_EQ(json.at("lost_bodies").at(0), "BOX001");
}

}  // namespace
}  // namespace snug::validation
