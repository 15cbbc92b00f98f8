// Recordings that are not what they seem: jumps go, lost markers stay lost, what is taken for granted is checked.
#include "snug/identification/internal/recording_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kJumpNoise = 2e-4, kJumpTurn = 2e-3;  // m, rad

/// A box that flies and tumbles, seen by a tracker of that noise.
RecordedMotion flying_box(std::size_t samples, std::uint64_t seed) {
  Rng rng = Rng(seed).split("flying box");
  RecordedMotion motion;
  motion.name = "toss.csv";
  motion.tracked.push_back({"parcel", {}, {}, {}});
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / 120.0;
    const auto normal = [&](double size) { return normal3(rng, size); };
    const Vector3 p(1.2 * t, 0.3 * t, 1.0 + 1.5 * t - 4.905 * t * t);
    motion.times.push_back(t);
    motion.tracked[0].poses.emplace_back(
        Pose{exp_rotation(Vector3(0.0, 2.0 * t, 3.0 * t)) * exp_rotation(normal(kJumpTurn)), p + normal(kJumpNoise)});
  }
  return motion;
}

model::SceneTask jump_task() {
  model::SceneTask task;
  task.path = "task.yaml";
  task.position_noise = kJumpNoise;
  task.rotation_noise = kJumpTurn;
  task.start.from = model::StartFrom::Scenario;
  return task;
}

std::vector<std::size_t> lost_of(const RecordedMotion& motion) {
  std::vector<std::size_t> lost;
  for (std::size_t k = 0; k < motion.times.size(); ++k)
    if (!record::is_tracked(motion.tracked[0].poses[k])) lost.push_back(k);
  return lost;
}

void turn(record::PoseSample& pose, const Vector3& by) { pose = Pose{pose.pose().R * exp_rotation(by), pose.p}; }

TEST(RejectJumps, LeavesASoundFlightAsItIs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RecordedMotion before = flying_box(80, seed);
    RecordedMotion after = before;
    reject_jumps(jump_task(), after);
    EXPECT_EQ(after, before) << seed;  // gravity bends the line by 0.3 mm a sample squared: less than eight deviations
  }
}

TEST(RejectJumps, TakesOutPlacesAndTurnsThatJumpAndNoOthers) {
  RecordedMotion motion = flying_box(100, 1);
  std::vector<record::PoseSample>& poses = motion.tracked[0].poses;
  // Neighbours two samples away are g (1 / 60 s)^2 / 2 = 1.4 mm off the line in free fall: the limit is 12 mm.
  poses[33].p.x() += 0.016;
  poses[50].p.z() -= 0.008;
  turn(poses[70], Vector3(0.0, 0.1, 0.0));
  poses[98].p.y() -= 0.02;
  reject_jumps(jump_task(), motion);
  EXPECT_EQ(lost_of(motion), (std::vector<std::size_t>{33, 70, 98}));
  EXPECT_EQ(motion.tracked[0].rejected, 3);
}

TEST(RejectJumps, DoesNotJudgeTheFirstAndTheLastSample) {
  // A line through three samples on one side is no measure of a fourth.
  RecordedMotion motion = flying_box(100, 2);
  motion.tracked[0].poses.front().p.z() += 0.02;
  motion.tracked[0].poses.back().p.z() += 0.02;
  reject_jumps(jump_task(), motion);
  EXPECT_TRUE(lost_of(motion).empty());
  EXPECT_EQ(motion.tracked[0].rejected, 0);
}

TEST(RejectJumps, TakesOutHalfTurnsWhateverTheirSign) {
  // A vector of half a turn and its opposite are one rotation: which of them is found is chance.
  for (const double angle : {std::numbers::pi - 0.02, std::numbers::pi, std::numbers::pi + 0.02})
    for (int axis = 0; axis < 3; ++axis) {
      SCOPED_TRACE(axis);
      RecordedMotion motion = flying_box(60, 11);
      for (const std::size_t k : {30U, 31U}) turn(motion.tracked[0].poses[k], angle * Vector3::Unit(axis));
      reject_jumps(jump_task(), motion);
      EXPECT_EQ(lost_of(motion), (std::vector<std::size_t>{30, 31}));
    }
}

TEST(RejectJumps, CallsNothingAnOutlierThatIsCommon) {
  // Every eighth sample is off: that is what this recording is like.
  RecordedMotion motion = flying_box(96, 3);
  for (std::size_t k = 4; k < 96; k += 8) motion.tracked[0].poses[k].p.y() += 0.02;
  const RecordedMotion before = motion;
  reject_jumps(jump_task(), motion);
  EXPECT_EQ(motion, before);
}

TEST(RejectJumps, ReadsOverSamplesThatWereLostAnyway) {
  RecordedMotion motion = flying_box(100, 4);
  for (const std::size_t k : {40U, 41U, 43U}) motion.tracked[0].poses[k] = record::lost_pose();
  motion.tracked[0].poses[42].p.x() += 0.02;
  reject_jumps(jump_task(), motion);
  EXPECT_EQ(lost_of(motion), (std::vector<std::size_t>{40, 41, 42, 43}));
  EXPECT_EQ(motion.tracked[0].rejected, 1);
}

TEST(RejectJumps, JudgesByWhatNeighboursScatterWhereThatIsMoreThanTheTaskSays) {
  // Ten times as noisy as declared: what is six times that scatter is no jump, 60 times is.
  RecordedMotion motion = flying_box(100, 5);
  Rng rng = Rng(6).split("noisy");
  for (record::PoseSample& pose : motion.tracked[0].poses) pose.p += normal3(rng, 10.0 * kJumpNoise);
  motion.tracked[0].poses[50].p.x() += 60.0 * 10.0 * kJumpNoise;
  reject_jumps(jump_task(), motion);
  const std::vector<std::size_t> lost = lost_of(motion);
  EXPECT_NE(std::ranges::find(lost, 50U), lost.end());
  EXPECT_LE(lost.size(), 4U);
}

TEST(RejectJumps, SaysNothingOfTooFewSamples) {
  RecordedMotion motion = flying_box(4, 7);
  motion.tracked[0].poses[2].p.x() += 1.0;
  reject_jumps(jump_task(), motion);
  EXPECT_TRUE(lost_of(motion).empty());
}

TEST(RejectJumps, JudgesEachBodyByItself) {
  RecordedMotion motion = flying_box(100, 8);
  motion.tracked.push_back(flying_box(100, 9).tracked[0]);
  motion.tracked[1].poses[20].p.x() += 0.05;
  reject_jumps(jump_task(), motion);
  EXPECT_EQ(motion.tracked[0].rejected, 0);
  EXPECT_EQ(motion.tracked[1].rejected, 1);
}

/// The scenario that such a flight starts in.
model::Scenario flight_scenario() {
  return model::parse_scenario(R"(name: flight
materials: [{name: any}]
bodies:
  - {name: parcel, size: [0.2, 0.16, 0.1], mass: 0.8, material: any, pose: {position: [0, 0, 1.0]}}
)",
                               "scene.yaml");
}

void expect_convention(const std::function<void(RecordedMotion&)>& spoil, const std::string& part,
                       model::SceneTask task = jump_task()) {
  RecordedMotion motion = flying_box(60, 10);
  spoil(motion);
  if (part.empty()) {
    EXPECT_NO_THROW(check_conventions(task, flight_scenario(), motion));
  } else {
    identification::test::expect_refused([&] { check_conventions(task, flight_scenario(), motion); }, part);
  }
}

TEST(Conventions, OfASoundRecordingAreOurs) {
  expect_convention([](RecordedMotion&) {}, "");
}

TEST(Conventions, TakeSlowSamplesForMillisecondsUnlessOnlyTheEndCounts) {
  const auto slow = [](double period) {
    return [period](RecordedMotion& motion) {
      for (std::size_t k = 0; k < motion.times.size(); ++k) motion.times[k] = period * static_cast<double>(k);
    };
  };
  expect_convention(slow(8.33), "look like milliseconds");
  expect_convention(slow(8.33), "samples 8.33 s apart in toss.csv");
  expect_convention(slow(0.5), "");
  model::SceneTask final_state = jump_task();
  final_state.only_final_state = true;
  expect_convention(slow(8.33), "", final_state);
  // One pause makes no recording slow.
  expect_convention(
      [](RecordedMotion& motion) {
        for (std::size_t k = 30; k < motion.times.size(); ++k) motion.times[k] += 20.0;
      },
      "");
}

TEST(Conventions, TakePlacesForMillimetresOnlyWhereThatBringsThemNear) {
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses) pose.p *= 1e3;
      },
      "look like millimetres");
  // A recorded world whose origin is far away is another thing, and no error of units.
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses) pose.p.x() += 5000.0;
      },
      "");
}

TEST(Conventions, TellAQuaternionWrittenScalarLast) {
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses)
          pose.quat = Quaternion(pose.quat.x(), pose.quat.y(), pose.quat.z(), pose.quat.w());
      },
      "look like x, y, z, w");
  // From the first row on no orientation is expected: there is nothing to compare with.
  model::SceneTask first_row = jump_task();
  first_row.start.from = model::StartFrom::FirstRow;
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses) turn(pose, Vector3(0.0, 0.0, 3.1));
      },
      "", first_row);
}

TEST(Conventions, NameTheAxisOfAFrameThatIsTurnedByHalf) {
  for (int axis = 0; axis < 2; ++axis) {  // about z it is what x, y, z, w look like
    const std::string name(1, "xyz"[axis]);
    expect_convention(
        [axis](RecordedMotion& motion) {
          for (record::PoseSample& pose : motion.tracked[0].poses) turn(pose, 3.1 * Vector3::Unit(axis));
        },
        "half a turn about its " + name + " axis");
  }
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses) turn(pose, Vector3(0.0, 0.0, 2.5));
      },
      "");  // 143 degrees is no half turn: a start that is off
}

TEST(Conventions, TellMarkersTakenForTheirMirrorImage) {
  const auto flipped = [](std::size_t from, std::size_t until) {
    return [from, until](RecordedMotion& motion) {
      for (std::size_t k = from; k < until; ++k)
        turn(motion.tracked[0].poses[k], Vector3(0.0, std::numbers::pi - 0.01, 0.0));
    };
  };
  expect_convention(flipped(30, 60), "a half turn about its y axis between two samples, at 0.25 s");
  // For two samples it is a jump, which is left out instead.
  expect_convention(flipped(30, 32), "");
}

TEST(Conventions, LeaveABodyThatTheScenarioDoesNotHave) {
  expect_convention(
      [](RecordedMotion& motion) {
        motion.tracked[0].body = "other";
        for (record::PoseSample& pose : motion.tracked[0].poses) pose.p *= 1e3;
      },
      "");
}

TEST(Conventions, LeaveABodyThatWasNeverSeen) {
  expect_convention(
      [](RecordedMotion& motion) {
        for (record::PoseSample& pose : motion.tracked[0].poses) pose = record::lost_pose();
      },
      "");
}

}  // namespace
}  // namespace snug::identification::internal
