// RecordedDrive: outputs as bits, boxes that stand, come and are picked; smoothed paths and what noise does to them.
#include "snug/identification/recorded_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/identification/driven_path.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification {
namespace {

constexpr double kDriveTick = 0.008;

/// A log of a tool that stands still over a box at (0.4, 0, 0), outputs by the functions of time.
template <class Bits>
record::ArchiveRecording still_log(double duration, const Bits& bits) {
  record::ArchiveRecording recording;
  recording.robot.names = {"actual_q_0", "actual_digital_output_bits"};
  recording.robot.columns.resize(2);
  for (int k = 0; kDriveTick * k <= duration; ++k) {
    recording.robot.times.push_back(70.0 + kDriveTick * k);
    recording.robot.tool.emplace_back(Pose{Matrix3::Identity(), Vector3(0.4, 0.0, 0.1)});
    recording.robot.columns[0].push_back(3.0);  // of another column
    recording.robot.columns[1].push_back(bits(kDriveTick * k));
  }
  return recording;
}

/// Poses at 100 Hz of one body; lost where the function says so.
template <class At>
validation::Measurement seen_body(double duration, const At& at) {
  validation::Measurement measured;
  measured.bodies.resize(1);
  for (int k = 0; 0.01 * k <= duration; ++k) {
    measured.pose_times.push_back(0.01 * k);
    measured.bodies[0].push_back(at(0.01 * k));
  }
  return measured;
}

RecordedDrive drive_of(const record::ArchiveRecording& recording, const validation::Measurement& measured) {
  return make_drive(recording, run_of_log(recording, {"BOX"}), measured, kDriveTick);
}

const Pose kStands{exp_rotation(Vector3(0.0, 0.0, 0.2)), Vector3(0.4, 0.0, 0.0)};
const auto kAlwaysThere = [](double) { return record::PoseSample(kStands); };

TEST(RecordedDriveLog, NeedsToolAndOutputs) {
  const auto off = [](double) { return 0.0; };
  record::ArchiveRecording recording = still_log(1.0, off);
  EXPECT_TRUE(has_drive(recording));
  recording.robot.names[1] = "actual_digital_input_bits";
  EXPECT_FALSE(has_drive(recording));
  recording = still_log(1.0, off);
  recording.robot.tool[5] = record::lost_pose();
  EXPECT_FALSE(has_drive(recording));
  EXPECT_FALSE(has_drive(still_log(0.05, off))) << "seven samples are no path";
  EXPECT_FALSE(has_drive({}));
}

TEST(RecordedDriveLog, HasVacuumAndBlowOffAsTheFirstTwoBits) {
  const record::ArchiveRecording recording = still_log(1.0, [](double t) {
    const bool vacuum = t > 0.2 && t<0.6, blow = t> 0.6 && t < 0.7;
    return (vacuum ? 1.0 : 0.0) + (blow ? 2.0 : 0.0) + 4.0 + 64.0;  // others are on all along
  });
  const validation::SimulatedRun run = run_of_log(recording, {"BOX", "OTHER"});
  EXPECT_EQ(run.times.front(), 0.0);
  EXPECT_EQ(run.header.bodies[1].name, "OTHER");
  EXPECT_FALSE(record::is_tracked(run.bodies[0][0]));
  const RecordedDrive drive = drive_of(recording, seen_body(1.0, kAlwaysThere));
  for (std::size_t k = 0; k < drive.tool.size(); ++k) {
    const double t = kDriveTick * static_cast<double>(k);
    if (std::abs(t - 0.2) > kDriveTick && std::abs(t - 0.6) > kDriveTick) {
      EXPECT_EQ(drive.vacuum[k], t > 0.2 && t < 0.6) << t;
    }
    if (std::abs(t - 0.6) > kDriveTick && std::abs(t - 0.7) > kDriveTick) {
      EXPECT_EQ(drive.blow_off[k], t > 0.6 && t < 0.7) << t;
    }
    EXPECT_LT(drive.tool[k].V_WE.linear.norm() + drive.tool[k].V_WE.angular.norm(), 1e-9);
  }
}

TEST(RecordedDriveLog, SaysSinceWhenABoxStoodWhereItWasPicked) {
  const record::ArchiveRecording recording = still_log(6.0, [](double t) { return t > 4.0 ? 1.0 : 0.0; });
  // Pushed along until 2.5 s, then it stands; picked at 4 s and carried off.
  const validation::Measurement measured = seen_body(6.0, [](double t) {
    const double aside = t < 2.5 ? 0.2 * (2.5 - t) : 0.0, up = t > 4.2 ? 0.1 * (t - 4.2) : 0.0;
    return record::PoseSample(Pose{kStands.R, kStands.p + Vector3(0.0, aside, up)});
  });
  const RecordedDrive drive = drive_of(recording, measured);
  ASSERT_EQ(drive.arrivals.size(), 1U);
  EXPECT_EQ(drive.arrivals[0].parcel, "BOX");
  EXPECT_NEAR(drive.arrivals[0].time, 2.5, 0.021);  // 3 mm at 0.2 m/s is 15 ms, and a sample
  EXPECT_LT((drive.arrivals[0].X_WP.p - kStands.p).norm(), 1e-9);
  EXPECT_LT(angle_between(drive.arrivals[0].X_WP.R, kStands.R), 1e-9);
}

TEST(RecordedDriveLog, OfAVacuumFarFromTheBoxPicksNothing) {
  const record::ArchiveRecording recording = still_log(3.0, [](double t) { return t > 1.0 ? 1.0 : 0.0; });
  const auto far = [](double) { return record::PoseSample(Pose{Matrix3::Identity(), Vector3(-0.5, 0.0, 0.0)}); };
  const RecordedDrive drive = drive_of(recording, seen_body(3.0, far));
  ASSERT_EQ(drive.arrivals.size(), 1U);  // it stands there all along
  EXPECT_EQ(drive.arrivals[0].time, 0.0);
  const RecordedDrive none = drive_of(recording, seen_body(3.0, [](double) { return record::lost_pose(); }));
  EXPECT_TRUE(none.arrivals.empty());
}

/// A path that speeds up, goes and brakes, with noise.
DrivenPath noisy_path(double noise, std::uint64_t seed) {
  Rng rng = Rng(seed).split("noisy path");
  RecordedBody body{"pusher", {}, {}, {}};
  std::vector<double> times;
  for (int k = 0; k < 150; ++k) {
    const double t = k / 120.0;
    times.push_back(t);
    body.poses.emplace_back(Pose{
        exp_rotation(Vector3(0.0, 0.0, 0.4 * std::sin(2.0 * t))) * exp_rotation(internal::normal3(rng, 10.0 * noise)),
        Vector3(0.3 * std::sin(2.0 * t), 0.0, 0.05) + internal::normal3(rng, noise)});
  }
  return smooth_path(times, body);
}

TEST(DrivenPath, FindsItsNoiseAndTakesMostOfItOut) {
  const DrivenPath path = noisy_path(1e-3, 1);
  EXPECT_NEAR(path.position_noise(), 1e-3, 2e-4);
  EXPECT_NEAR(path.rotation_noise(), 1e-2, 2e-3);
  double square = 0.0;
  for (std::size_t k = 0; k < path.position.times.size(); ++k) {
    const double off =
        path.position.values(static_cast<Eigen::Index>(k), 0) - 0.3 * std::sin(2.0 * path.position.times[k]);
    square += off * off / 150.0;
  }
  // As many unknowns as the smoothing leaves, of 150: so much of the variance.
  EXPECT_LT(std::sqrt(square), 1e-3 * 2.0 * std::sqrt(path.position.unknowns / 150.0));
}

TEST(DrivenPath, DrawnAgainIsOffByWhatTheNoiseLeaves) {
  const DrivenPath path = noisy_path(1e-3, 2);
  Rng rng = Rng(7).split("again"), same = Rng(7).split("again");
  double square = 0.0;
  constexpr int kDraws = 60;
  for (int k = 0; k < kDraws; ++k)
    square += (draw_again(path, rng).position.values - path.position.values).squaredNorm() / (kDraws * 150.0 * 3.0);
  const double expected = path.position.noise * std::sqrt(path.position.unknowns / 150.0);
  EXPECT_NEAR(std::sqrt(square) / expected, 1.0, 0.35);  // and what smoothing does where the path bends
  EXPECT_EQ(draw_again(path, same).position.values, [&] {
    Rng first = Rng(7).split("again");
    return draw_again(path, first).position.values;
  }());
}

TEST(DrivenPath, MovesTowardsOthersByTheirShares) {
  const DrivenPath path = noisy_path(1e-3, 3), a = noisy_path(1e-3, 4), b = smooth_again(path);
  const DrivenPath none = moved_towards(path, {a, b}, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(none.position.values, path.position.values);
  const DrivenPath whole = moved_towards(path, {a}, Eigen::VectorXd::Ones(1));
  EXPECT_LT((whole.position.values - a.position.values).norm(), 1e-12);
  EXPECT_LT((whole.rotation.values - a.rotation.values).norm(), 1e-12);
  const DrivenPath both = moved_towards(path, {a, b}, Eigen::Vector2d(0.5, -2.0));
  EXPECT_LT((both.position.values - path.position.values - 0.5 * (a.position.values - path.position.values) +
             2.0 * (b.position.values - path.position.values))
                .norm(),
            1e-12);
}

TEST(DrivenPath, HasRotationsWhateverItsQuaternionsAreSmoothedTo) {
  for (const model::PathPoint& point : pose_path_of(noisy_path(2e-2, 5), 0.3).points)
    EXPECT_LT((point.X_WB.R.transpose() * point.X_WB.R - Matrix3::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace snug::identification
