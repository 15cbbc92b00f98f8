// SimulatedRun: columns are those of the frames; PoseCursor is the slow way of looking between two samples.
#include "snug/validation/simulated_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/archive.hpp"
#include "snug/record/writer.hpp"

namespace snug::validation {
namespace {

using record::PoseSample;

constexpr double kAnyLength = std::numeric_limits<double>::infinity();

/// Samples of a body that moves evenly and turns evenly, at uneven times.
struct EvenMotion {
  EvenMotion() {
    for (int i = 0; i < 40; ++i) {
      times.push_back(0.01 * i + 0.003 * std::sin(2.0 * i));
      poses.emplace_back(at(times.back()));
    }
  }
  static Pose at(double t) {
    return {exp_rotation(Vector3(0.0, 0.0, 1.0)) * exp_rotation(t * Vector3(2.0, -1.0, 0.5)),
            Vector3(1.0 + t, 2.0 - 3.0 * t, 0.1)};
  }
  std::vector<double> times;
  std::vector<PoseSample> poses;
};

TEST(PoseCursor, IsOnTheLineAndTheShortestTurnBetweenSamples) {
  const EvenMotion motion;
  PoseCursor cursor(motion.times, motion.poses);
  for (double t = motion.times.front(); t <= motion.times.back(); t += 0.0007) {
    const PoseSample found = cursor.at(t, kAnyLength);
    ASSERT_TRUE(record::is_tracked(found)) << t;
    EXPECT_LT((found.p - EvenMotion::at(t).p).norm(), 1e-12);
    EXPECT_LT(angle_between(found.pose().R, EvenMotion::at(t).R), 1e-7);
  }
}

TEST(PoseCursor, IsAsIfEachTimeWereAskedForAlone) {
  const EvenMotion motion;
  PoseCursor cursor(motion.times, motion.poses);
  for (const double t : {0.0, 0.0, 0.05, 0.05, 0.051, 0.2, 0.3899}) {
    PoseCursor alone(motion.times, motion.poses);
    EXPECT_EQ(cursor.at(t, kAnyLength), alone.at(t, kAnyLength)) << t;
  }
}

TEST(PoseCursor, OfASampleIsTheSampleItselfEvenBesideALostOne) {
  EvenMotion motion;
  motion.poses[9] = motion.poses[11] = record::lost_pose();
  PoseCursor cursor(motion.times, motion.poses);
  EXPECT_EQ(cursor.at(motion.times[10], kAnyLength), motion.poses[10]);
  EXPECT_FALSE(record::is_tracked(cursor.at(0.5 * (motion.times[10] + motion.times[11]), kAnyLength)));
  EXPECT_FALSE(record::is_tracked(cursor.at(motion.times[11], kAnyLength)));
  EXPECT_TRUE(record::is_tracked(cursor.at(motion.times[12], kAnyLength)));
}

TEST(PoseCursor, IsLostOutsideAndInGapsThatAreTooLong) {
  const EvenMotion motion;
  PoseCursor before(motion.times, motion.poses), after(motion.times, motion.poses);
  EXPECT_FALSE(record::is_tracked(before.at(motion.times.front() - 1e-9, kAnyLength)));
  EXPECT_FALSE(record::is_tracked(after.at(motion.times.back() + 1e-9, kAnyLength)));
  const std::vector<double> times = {0.0, 1.0, 1.5};
  const std::vector<PoseSample> poses(3, PoseSample(Pose{}));
  PoseCursor gaps(times, poses);
  EXPECT_FALSE(record::is_tracked(gaps.at(0.5, 0.6)));
  EXPECT_TRUE(record::is_tracked(gaps.at(1.0, 0.6)));
  EXPECT_TRUE(record::is_tracked(gaps.at(1.2, 0.6)));
}

TEST(PoseCursor, TurnsTheShortWayWhateverTheSignOfTheQuaternion) {
  const std::vector<double> times = {0.0, 1.0};
  std::vector<PoseSample> poses = {PoseSample(Pose{}),
                                   PoseSample(Pose{exp_rotation(Vector3(0.2, 0, 0)), Vector3::Zero()})};
  poses[1].p.setZero();
  for (const double sign : {1.0, -1.0}) {
    poses[1].quat.coeffs() *= sign;
    PoseCursor cursor(times, poses);
    EXPECT_LT(angle_between(cursor.at(0.5, kAnyLength).pose().R, exp_rotation(Vector3(0.1, 0, 0))), 1e-12) << sign;
  }
}

/// Two frames of a recording with two boxes, a static body and a joint.
record::Recording two_frames() {
  record::Recording recording;
  recording.header.record_period = 0.01;
  recording.header.dt = 0.001;
  for (const char* name : {"table", "BOX1", "BOX2", "ball"})
    recording.header.bodies.push_back({name, "", record::BodyKind::Dynamic, 1.0, {}, {}});
  recording.header.bodies[0].kind = record::BodyKind::Static;
  recording.header.bodies[1].type = recording.header.bodies[2].type = "B1";
  recording.header.joints = {"q0"};
  for (int i = 0; i < 2; ++i) {
    record::Frame frame;
    frame.time = 0.01 * i;
    frame.step = 10 * i;
    frame.X_WE = Pose{exp_rotation(Vector3(0.0, 0.3, 0.1 * i)), Vector3(0.1 * i, 0.2, 0.3)};
    frame.cup.X_ES = Pose{exp_rotation(Vector3(0.2, 0.0, 0.0)), Vector3(0.0, 0.01, 0.05)};
    frame.cup.attached_body = i == 0 ? -1 : 2;
    frame.cup.vacuum_command = i == 1;
    frame.cup.blow_off_command = i == 0;
    frame.F_flange.force = Vector3(1.0, 2.0, 3.0 * i);
    frame.bodies.resize(4);
    frame.bodies[2].present = i == 1;
    frame.bodies[2].X_WB.p = Vector3(4.0, 5.0, 6.0);
    frame.joints.push_back({0.5 * i, 0.0, 0.0});
    recording.frames.push_back(frame);
  }
  recording.events.push_back({0.01, "seal", "BOX2", "", {}});
  recording.result = "{}";
  return recording;
}

TEST(SimulatedRun, HasTheColumnsOfItsFrames) {
  const record::Recording recording = two_frames();
  const SimulatedRun run = make_run(recording, "r.h5");
  EXPECT_EQ(run.name, "r.h5");
  EXPECT_EQ(run.times, (std::vector<double>{0.0, 0.01}));
  EXPECT_FALSE(record::is_tracked(run.bodies[2][0])) << "not there yet";
  EXPECT_EQ(run.bodies[2][1].p, Vector3(4.0, 5.0, 6.0));
  EXPECT_EQ(run.attached, (std::vector<int>{-1, 2}));
  EXPECT_EQ(run.vacuum, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(run.blow_off, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(run.wrench[1].force, Vector3(1.0, 2.0, 3.0));
  ASSERT_EQ(run.joints.size(), 1U);
  EXPECT_EQ(run.joints[0][1].position, 0.5);
  EXPECT_EQ(run.events, recording.events);
  // The lip is where the cup's deformation puts it from the tool.
  const Pose X_WS = recording.frames[1].X_WE.pose() * recording.frames[1].cup.X_ES.pose();
  EXPECT_LT((run.lip[1].p - X_WS.p).norm(), 1e-12);
  EXPECT_LT(angle_between(run.lip[1].pose().R, X_WS.R), 1e-7);
}

TEST(SimulatedRun, OfAFileIsThatOfTheRecordingInIt) {
  const test::ScratchFolder folder;
  record::save_recording(folder / "r.h5", two_frames());
  const SimulatedRun loaded = load_run(folder / "r.h5"), made = make_run(two_frames(), "r.h5");
  EXPECT_EQ(loaded.name, made.name);
  EXPECT_EQ(loaded.times, made.times);
  EXPECT_EQ(loaded.tool, made.tool);
  EXPECT_EQ(loaded.lip, made.lip);
  EXPECT_EQ(loaded.attached, made.attached);
  EXPECT_EQ(loaded.wrench, made.wrench);
  EXPECT_EQ(loaded.bodies[2][1], made.bodies[2][1]);
  EXPECT_EQ(loaded.events, made.events);
  EXPECT_EQ(loaded.result, made.result);
}

TEST(SimulatedRun, NeedsTwoFrames) {
  record::Recording recording = two_frames();
  recording.frames.pop_back();
  try {
    (void)make_run(recording, "short.h5");
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "short.h5");
    EXPECT_EQ(error.got, "1 frames");
  }
}

TEST(FindBoxes, AreDynamicBodiesOfATypeOrAllDynamicOnesWhereNoneHasAType) {
  record::RecordingHeader header = two_frames().header;
  EXPECT_EQ(find_boxes(header), (std::vector<std::size_t>{1, 2}));
  header.bodies[0].type = "B9";  // a static one is no box
  EXPECT_EQ(find_boxes(header), (std::vector<std::size_t>{1, 2}));
  for (record::BodyInfo& body : header.bodies) body.type.clear();
  EXPECT_EQ(find_boxes(header), (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_TRUE(find_boxes({}).empty());
}

}  // namespace
}  // namespace snug::validation
