// Virtual experiments: at rest where they say so, noise of the size said, the same from the same seed.
#include "snug/identification/virtual_experiments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cup/law.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/identification/virtual_lift.hpp"

namespace snug::identification {
namespace {

const Matrix6 kVirtualK = cup::as_matrix(test::kTruth);

Pose deformation_in(const StaticPoses& poses, const StaticPose& pose) {
  return poses.frames.X_ES2.inverse() * pose.X_ES * poses.frames.X_SS1;
}

TEST(VirtualPoses, AreInBalanceAndWithinWhatTheyPromise) {
  Rng rng = Rng(4).split("promise");
  const StaticPoses poses = make_static_poses(kVirtualK, frames_of({}), 120, rng);
  ASSERT_EQ(poses.poses.size(), 120U);
  EXPECT_FALSE(poses.noise_is_given);
  for (std::size_t i = 0; i < poses.poses.size(); ++i) {
    const StaticPose& pose = poses.poses[i];
    EXPECT_EQ(pose.index, static_cast<int>(i));
    const Pose H = deformation_in(poses, pose);
    EXPECT_LE(cup::bend_angle(H.R), 35.0 * std::numbers::pi / 180.0);
    EXPECT_GE(pose.load->mass, 0.25);
    EXPECT_LE(pose.load->mass, 2.2);
    EXPECT_LE(pose.load->p_SScm.head<2>().cwiseAbs().maxCoeff(), 0.04);
    // Tilted from straight down, z of the gripper towards the ground, by 75 degrees at most.
    EXPECT_LE(pose.load->R_WE.col(2).z(), -std::cos(75.0 * std::numbers::pi / 180.0) + 1e-12);
    // The cup's wrench at the lip carries the weight: torque about the centre of mass is none.
    const Vector3 force = pose.wrench_S->head<3>(), torque = pose.wrench_S->tail<3>();
    EXPECT_NEAR(force.norm(), pose.load->mass * 9.81, 1e-9);
    EXPECT_LT((torque - pose.load->p_SScm.cross(force)).norm(), 1e-12);
    const Vector6 of_spring = cup::wrench_transform(poses.frames.X_SS1) * cup::spring_wrench(H, kVirtualK);
    EXPECT_LT((of_spring - *pose.wrench_S).norm(), 1e-8);
  }
}

TEST(VirtualPoses, ComeFromTheirSeed) {
  const auto draw = [](std::uint64_t seed, int count) {
    Rng rng = Rng(seed).split("seed");
    return make_static_poses(kVirtualK, frames_of({}), count, rng);
  };
  const StaticPoses a = draw(1, 20), b = draw(1, 20), more = draw(1, 30), other = draw(2, 20);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(a.poses[i].X_ES, b.poses[i].X_ES);
    EXPECT_EQ(a.poses[i].X_ES, more.poses[i].X_ES);
  }
  EXPECT_NE(a.poses[0].X_ES, other.poses[0].X_ES);
}

TEST(VirtualNoise, HasTheDeviationsSaid) {
  Rng rng = Rng(3).split("deviations");
  const StaticPoses exact = make_static_poses(kVirtualK, frames_of({}), 800, rng);
  StaticPoses noisy = exact;
  const MeasurementNoise noise{3e-4, 2e-3, 0.5, 0.03};
  add_noise(noisy, noise, rng);
  EXPECT_TRUE(noisy.noise_is_given);
  EXPECT_EQ(noisy.noise, noise);
  double position = 0.0, rotation = 0.0, force = 0.0, torque = 0.0;
  for (std::size_t i = 0; i < 800; ++i) {
    const StaticPose &a = exact.poses[i], &b = noisy.poses[i];
    position += (a.X_ES.p - b.X_ES.p).squaredNorm() / 2400.0;
    rotation += std::pow(angle_between(a.X_ES.R, b.X_ES.R), 2) / 2400.0;
    force += (*a.wrench_S - *b.wrench_S).head<3>().squaredNorm() / 2400.0;
    torque += (*a.wrench_S - *b.wrench_S).tail<3>().squaredNorm() / 2400.0;
    EXPECT_LT((b.X_ES.R.transpose() * b.X_ES.R - Matrix3::Identity()).norm(), 1e-12);
    EXPECT_EQ(a.load, b.load);  // what hangs is known
  }
  // A deviation of 2400 draws is known to 1.4 %: four of them.
  EXPECT_NEAR(std::sqrt(position) / noise.position, 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(rotation) / noise.rotation, 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(force) / noise.force, 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(torque) / noise.torque, 1.0, 0.06);
}

Pluck virtual_pluck(PluckDirection direction, double amplitude) {
  Pluck pluck;
  pluck.load_S = {0.55, Vector3(0.006, -0.004, 0.08), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  pluck.frames = frames_of({});
  pluck.K = kVirtualK;
  pluck.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.0});
  pluck.direction = direction;
  pluck.amplitude = amplitude;
  pluck.duration = 0.5;
  return pluck;
}

TEST(VirtualPluck, StartsAsideAndComesToRest) {
  const struct {
    PluckDirection direction;
    int axis;  // of the twist at S1
  } cases[] = {{PluckDirection::Lateral, 0},
               {PluckDirection::Axial, 2},
               {PluckDirection::Bend, 3},
               {PluckDirection::Torsion, 5}};
  for (const auto& [direction, axis] : cases) {
    SCOPED_TRACE(axis);
    const Release pulled = make_pluck(virtual_pluck(direction, 0.004)),
                  rest = make_pluck(virtual_pluck(direction, 0.0));
    ASSERT_EQ(pulled.times.size(), 180U);
    EXPECT_NEAR(pulled.times[1], 1.0 / 360.0, 1e-15);
    const auto deformation = [&](const Release& release, std::size_t i) {
      return release.frames.X_ES2.inverse() * release.X_ES[i] * release.frames.X_SS1;
    };
    const Pose H = deformation(pulled, 0), H_rest = deformation(rest, 0);
    Vector6 moved;
    moved << H.p - H_rest.p, log_rotation(H_rest.R.transpose() * H.R);
    EXPECT_LT((moved - 0.004 * Vector6::Unit(axis)).norm(), 1e-12);
    // Without a pull nothing moves; with one, less and less.
    EXPECT_LT((rest.X_ES.back().p - rest.X_ES.front().p).norm(), 1e-9);
    const auto away = [&](std::size_t first) {
      double most = 0.0;
      for (std::size_t i = first; i < first + 30; ++i)
        most = std::max(
            most, (pulled.X_ES[i].p - rest.X_ES[0].p).norm() + 0.02 * angle_between(pulled.X_ES[i].R, rest.X_ES[0].R));
      return most;
    };
    EXPECT_LT(away(150), 0.7 * away(0));
  }
}

TEST(VirtualPluck, NeedsACupThatHolds) {
  Pluck heavy = virtual_pluck(PluckDirection::Axial, 0.004);
  heavy.K *= 1e-4;
  test::expect_refused([&] { (void)make_pluck(heavy); }, "a lighter load or a stiffer cup");
}

Lift virtual_lift(double rate) {
  Lift lift;
  lift.load_S = {0.7, Vector3(0.01, -0.005, 0.06), Vector3(0.0025, 0.003, 0.004).asDiagonal()};
  lift.frames = frames_of({});
  lift.K = kVirtualK;
  lift.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.0});
  lift.rate = rate;
  return lift;
}

TEST(VirtualLift, MovesTheGripperAsItSays) {
  const std::vector<PayloadSample> lift = make_lift(virtual_lift(250.0));
  ASSERT_EQ(lift.size(), 376U);  // 1.5 s, both ends
  EXPECT_NEAR(lift[1].time - lift[0].time, 0.004, 1e-12);
  EXPECT_NEAR(lift.back().X_WE.p.z() - lift.front().X_WE.p.z(), 0.25, 1e-9);
  EXPECT_NEAR(lift.back().X_WE.p.x() - lift.front().X_WE.p.x(), 0.3, 1e-9);
  EXPECT_NEAR(angle_between(lift.back().X_WE.R, lift.front().X_WE.R), 0.25, 1e-9);
  for (const PayloadSample& sample : lift) EXPECT_FALSE(sample.X_ES);
}

TEST(VirtualLift, WrenchTimesTimeIsTheChangeOfMomentum) {
  // At rest before and nearly after: the mean force is the weight, times 1.5 s what gravity took.
  const std::vector<PayloadSample> lift = make_lift(virtual_lift(1000.0));
  Vector3 impulse = Vector3::Zero();
  for (std::size_t i = 1; i < lift.size(); ++i)
    impulse +=
        0.5e-3 * (lift[i - 1].X_WE.R * lift[i - 1].wrench_E.head<3>() + lift[i].X_WE.R * lift[i].wrench_E.head<3>());
  // What swings at the end still has some mm/s: 0.7 kg of it.
  EXPECT_LT((impulse - Vector3(0.0, 0.0, 0.7 * 9.81 * 1.5)).norm(), 0.7 * 0.05);
  EXPECT_NEAR((lift.front().X_WE.R * lift.front().wrench_E.head<3>()).z(), 0.7 * 9.81, 1e-6);
}

TEST(VirtualLift, HasOneBiasForAllSamplesAndNoiseForEach) {
  const std::vector<PayloadSample> exact = make_lift(virtual_lift(500.0));
  std::vector<PayloadSample> only_bias = exact, noisy = exact;
  Rng rng = Rng(5).split("bias"), again = Rng(5).split("bias");
  add_noise(only_bias, {0.0, 0.0, 0.0, 0.0}, 0.4, 0.05, rng);
  const Vector6 bias = only_bias[0].wrench_E - exact[0].wrench_E;
  EXPECT_GT(bias.head<3>().norm(), 0.05);
  for (std::size_t i = 0; i < exact.size(); ++i)
    EXPECT_LT((only_bias[i].wrench_E - exact[i].wrench_E - bias).norm(), 1e-12);
  add_noise(noisy, {0.0, 0.0, 0.3, 0.02}, 0.4, 0.05, again);
  Vector6 mean = Vector6::Zero();
  for (std::size_t i = 0; i < exact.size(); ++i)
    mean += (noisy[i].wrench_E - exact[i].wrench_E) / static_cast<double>(exact.size());
  EXPECT_LT((mean - bias).head<3>().cwiseAbs().maxCoeff(), 4.5 * 0.3 / std::sqrt(751.0));
}

}  // namespace
}  // namespace snug::identification
