// Misfit of one static pose: carried noise, balances and their derivatives, and that the residual is of unit
// covariance.
#include "snug/identification/internal/pose_misfit.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

const Matrix6 kMisfitK = cup::as_matrix(identification::test::kTruth);

CupFrames tilted_frames() {
  CupFrames frames = frames_of({});
  frames.X_SS1 = {exp_rotation(Vector3(0.1, -0.2, 0.3)), Vector3(0.004, -0.003, -0.02)};
  frames.X_ES2.p = Vector3(0.002, 0.001, 0.03);
  return frames;
}

StaticPoses rest_poses(int count, const CupFrames& frames = frames_of({})) {
  Rng rng = Rng(21).split("rest");
  return make_static_poses(kMisfitK, frames, count, rng);
}

Pose moved_by(const Pose& H, const Vector6& nu) { return H * Pose{exp_rotation(nu.tail<3>()), nu.head<3>()}; }

TEST(NoiseAtS1, IsTheScatterOfNoiseCarriedThere) {
  const CupFrames frames = tilted_frames();
  const MeasurementNoise noise{1e-4, 2e-3, 0.3, 0.02};
  const NoiseAtS1 carried = carry_noise(noise, frames);
  Rng rng = Rng(6).split("carried");
  constexpr int kDraws = 4000;
  Matrix6 of_pose = Matrix6::Zero(), of_wrench = Matrix6::Zero();
  for (int i = 0; i < kDraws; ++i) {
    // A lip whose pose is off by a small twist: S1, fixed to it, is off by that twist seen from S1.
    const Vector3 shift = normal3(rng, noise.position), turn = normal3(rng, noise.rotation);
    const Pose off = frames.X_SS1.inverse() * Pose{exp_rotation(turn), shift} * frames.X_SS1;
    const Vector6 twist = (Vector6() << off.p, log_rotation(off.R)).finished();
    of_pose += twist * twist.transpose() / kDraws;
    // A wrench at S seen from S1: the same force, its torque about another point.
    const Vector3 force = normal3(rng, noise.force), torque = normal3(rng, noise.torque);
    const Matrix3 R = frames.X_SS1.R.transpose();
    const Vector6 there = (Vector6() << R * force, R * (torque - frames.X_SS1.p.cross(force))).finished();
    of_wrench += there * there.transpose() / kDraws;
  }
  // A variance of 4000 draws is known to 2.2 %, a correlation to 0.016: five of each.
  const auto expect_alike = [](const Matrix6& scatter, const Matrix6& covariance) {
    const Vector6 size = covariance.diagonal().cwiseSqrt();
    const Matrix6 off = size.cwiseInverse().asDiagonal() * (scatter - covariance) * size.cwiseInverse().asDiagonal();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.11) << off;
  };
  expect_alike(of_pose, carried.pose);
  expect_alike(of_wrench, carried.wrench);
}

TEST(NoiseAtS1, OfNothingIsAMillionthOfTheUsual) {
  const NoiseAtS1 none = carry_noise({0.0, 0.0, 0.0, 0.0}, frames_of({})), usual = carry_noise({}, frames_of({}));
  EXPECT_TRUE(is_positive_definite(none.pose) && is_positive_definite(none.wrench));
  EXPECT_LT((1e12 * none.pose_S - usual.pose_S).norm(), 1e-9 * usual.pose_S.norm());
  EXPECT_LT((1e12 * none.wrench - usual.wrench).norm(), 1e-9 * usual.wrench.norm());
  // Twists there and back, and wrenches: their power is the same wherever it is counted.
  const NoiseAtS1 tilted = carry_noise({}, tilted_frames());
  EXPECT_LT((tilted.to_S1 * tilted.from_S.transpose() - Matrix6::Identity()).norm(), 1e-12);
}

TEST(Balance, OfGravityIsThatOfAnExactSensor) {
  // The sensor of make_static_poses is exact: both wrenches are those of the same load.
  for (const CupFrames& frames : {frames_of({}), tilted_frames()}) {
    const StaticPoses poses = rest_poses(20, frames);
    const std::vector<Balance> sensed = make_balances(poses, WrenchSource::Sensor),
                               weighed = make_balances(poses, WrenchSource::Gravity);
    for (std::size_t i = 0; i < sensed.size(); ++i) {
      EXPECT_LT((sensed[i].wanted(sensed[i].H) - weighed[i].wanted(weighed[i].H)).norm(), 1e-12);
      EXPECT_LT((sensed[i].wanted(sensed[i].H) - cup::spring_wrench(sensed[i].H, kMisfitK)).norm(), 1e-8);
    }
  }
}

TEST(Balance, KnowsHowGravitysWrenchChangesWithThePose) {
  const std::vector<Balance> weighed = make_balances(rest_poses(10, tilted_frames()), WrenchSource::Gravity),
                             sensed = make_balances(rest_poses(1), WrenchSource::Sensor);
  for (const Balance& balance : weighed) {
    constexpr double kStep = 1e-6;
    const Matrix6 T = balance.wanted_tangent(balance.H);
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6 nu = kStep * Vector6::Unit(axis);
      const Vector6 numeric =
          (balance.wanted(moved_by(balance.H, nu)) - balance.wanted(moved_by(balance.H, -nu))) / (2.0 * kStep);
      EXPECT_LT((numeric - T.col(axis)).norm(), 1e-7);  // rounding of 20 N over 2e-6
    }
    EXPECT_EQ(T.leftCols<3>().norm(), 0.0);  // weight is the same everywhere
  }
  EXPECT_EQ(sensed.front().wanted_tangent(sensed.front().H), Matrix6(Matrix6::Zero()));
}

TEST(Balance, NeedsWhatItsSourceReads) {
  StaticPoses poses = rest_poses(2);
  poses.poses[1].where = "p.csv:7";
  poses.poses[1].load = {};
  identification::test::expect_refused([&] { (void)make_balances(poses, WrenchSource::Gravity); }, "p.csv:7");
  poses.poses[1].wrench_S = {};
  identification::test::expect_refused([&] { (void)make_balances(poses, WrenchSource::Sensor); }, "--wrench gravity");
}

TEST(PoseMisfit, VanishesInBalance) {
  const StaticPoses poses = rest_poses(15, tilted_frames());
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  for (const WrenchSource source : {WrenchSource::Sensor, WrenchSource::Gravity})
    for (const Balance& balance : make_balances(poses, source)) {
      EXPECT_LT(compute_misfit(balance, kMisfitK, noise, poses.frames, nullptr).residual.norm(), 1e-6);
      EXPECT_LT(compute_prediction_error(balance, kMisfitK, poses.frames).norm(), 1e-9);
    }
}

TEST(PoseMisfit, OfNoiseHasUnitCovariance) {
  // The mean square of each of six components over draws of the noise is 1 +- sqrt(2 / draws).
  for (const WrenchSource source : {WrenchSource::Sensor, WrenchSource::Gravity}) {
    SCOPED_TRACE(name_of(source));
    StaticPoses exact = rest_poses(1);
    const MeasurementNoise noise;
    const NoiseAtS1 carried = carry_noise(noise, exact.frames);
    constexpr int kDraws = 1500;
    Matrix6 covariance = Matrix6::Zero();
    Vector6 mean = Vector6::Zero();
    Rng rng = Rng(31).split("unit covariance");
    for (int i = 0; i < kDraws; ++i) {
      StaticPoses noisy = exact;
      add_noise(noisy, noise, rng);
      const Balance balance = make_balances(noisy, source).front();
      const Vector6 r = compute_misfit(balance, kMisfitK, carried, exact.frames, nullptr).residual;
      mean += r / kDraws;
      covariance += r * r.transpose() / kDraws;
    }
    // Four deviations of a variance, 4 sqrt(2 / 1500) = 0.15, and five of a mean, 5 / sqrt(1500) = 0.13.
    EXPECT_LT((covariance - Matrix6::Identity()).cwiseAbs().maxCoeff(), 0.17) << covariance;
    EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.13) << mean.transpose();
  }
}

TEST(PoseMisfit, WhiteningIsMinusItsDerivativeByTheWrench) {
  const StaticPoses poses = rest_poses(4);
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  for (Balance balance : make_balances(poses, WrenchSource::Sensor)) {
    balance.wrench_S1 += (Vector6() << 0.4, -0.3, 0.5, 0.02, 0.03, -0.01).finished();
    const Misfit at = compute_misfit(balance, kMisfitK, noise, poses.frames, nullptr);
    const Vector6 size = noise.wrench.diagonal().cwiseSqrt();
    for (int axis = 0; axis < 6; ++axis) {
      const auto residual = [&](double sign) {
        Balance shifted = balance;
        shifted.wrench_S1[axis] += sign * 1e-3 * size[axis];
        return compute_misfit(shifted, kMisfitK, noise, poses.frames, nullptr).residual;
      };
      const Vector6 numeric = (residual(1.0) - residual(-1.0)) / 2e-3;  // for a deviation of the wrench
      // The whitening itself changes with the pose that it is taken at: some percent of the change at such a misfit.
      EXPECT_LT((numeric + at.whitening.col(axis) * size[axis]).norm(), 0.05);
    }
  }
}

TEST(PoseMisfit, SquareIsTheSameFromAllSides) {
  // A symmetric cup with gripper, load and readings turned together about its axis: nothing that counts is another.
  const StaticPoses poses = rest_poses(6);
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  Rng rng = Rng(8).split("sides");
  StaticPoses noisy = poses;
  add_noise(noisy, {}, rng);
  const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, 1.1));
  StaticPoses turned = noisy;
  for (StaticPose& pose : turned.poses) {
    pose.X_ES = {R * pose.X_ES.R * R.transpose(), R * pose.X_ES.p};
    pose.wrench_S->head<3>() = (R * pose.wrench_S->head<3>()).eval();
    pose.wrench_S->tail<3>() = (R * pose.wrench_S->tail<3>()).eval();
  }
  const std::vector<Balance> a = make_balances(noisy, WrenchSource::Sensor),
                             b = make_balances(turned, WrenchSource::Sensor);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double square = compute_misfit(a[i], kMisfitK, noise, poses.frames, nullptr).residual.squaredNorm();
    EXPECT_NEAR(compute_misfit(b[i], kMisfitK, noise, poses.frames, nullptr).residual.squaredNorm(), square,
                1e-8 * (1.0 + square));
    EXPECT_NEAR(compute_prediction_error(b[i], kMisfitK, poses.frames).norm(),
                compute_prediction_error(a[i], kMisfitK, poses.frames).norm(), 1e-10);
  }
}

TEST(PoseMisfit, FallsWithTheSquareOfANoiseThatIsThoughtLarger) {
  StaticPoses poses = rest_poses(5);
  Rng rng = Rng(12).split("larger");
  add_noise(poses, {}, rng);
  const MeasurementNoise usual,
      larger{3.0 * usual.position, 3.0 * usual.rotation, 3.0 * usual.force, 3.0 * usual.torque};
  const NoiseAtS1 one = carry_noise(usual, poses.frames), three = carry_noise(larger, poses.frames);
  for (const Balance& balance : make_balances(poses, WrenchSource::Sensor)) {
    const Vector6 r = compute_misfit(balance, kMisfitK, one, poses.frames, nullptr).residual;
    const Vector6 r3 = compute_misfit(balance, kMisfitK, three, poses.frames, nullptr).residual;
    EXPECT_LT((3.0 * r3 - r).norm(), 1e-6 * (1.0 + r.norm()));  // poses move by the same: all variances grow alike
  }
}

TEST(PredictionError, IsTheShiftOfAMeasuredPose) {
  StaticPoses poses = rest_poses(8);
  const Vector6 off = (Vector6() << 0.0004, -0.0003, 0.0005, 0.003, -0.002, 0.004).finished();
  for (StaticPose& pose : poses.poses) pose.X_ES = moved_by(pose.X_ES, off);
  for (const Balance& balance : make_balances(poses, WrenchSource::Gravity)) {
    // The equilibrium is the lip's place before it was shifted, whatever the shift: the load is known.
    const Vector6 error = compute_prediction_error(balance, kMisfitK, poses.frames);
    EXPECT_LT((error - off).norm(), 1e-7) << error.transpose();
  }
}

TEST(AtRest, HangsStraightWhereTheCentreOfMassIsBelowTheLip) {
  const Matrix3 down = Vector3(1.0, -1.0, -1.0).asDiagonal();
  const SpatialInertia load{0.8, Vector3(0.0, 0.0, 0.05), Matrix3(0.002 * Matrix3::Identity())};
  const cup::SettleResult rest = hang(load, down, kMisfitK, frames_of({}));
  EXPECT_LT(log_rotation(rest.H.R).norm(), 1e-12);
  EXPECT_NEAR(rest.H.p.z(), 0.8 * 9.81 / identification::test::kTruth.axial, 1e-9);  // the spring's length: m g / k
  EXPECT_LT(rest.H.p.head<2>().norm(), 1e-12);
}

TEST(AtRest, RefusesALoadThatTheCupDoesNotHold) {
  const Matrix3 aside = exp_rotation(Vector3(std::numbers::pi / 2.0, 0.0, 0.0)) * Vector3(1.0, -1.0, -1.0).asDiagonal();
  const SpatialInertia heavy{30.0, Vector3(0.0, 0.0, 0.3), Matrix3(0.2 * Matrix3::Identity())};
  identification::test::expect_refused([&] { (void)hang(heavy, aside, kMisfitK, frames_of({})); }, "a lighter load");
}

TEST(AtRest, NoiseHasItsDeviationInEachAxis) {
  Rng rng = Rng(77).split("normal3");
  Matrix3 covariance = Matrix3::Zero();
  constexpr int kDraws = 5000;
  for (int i = 0; i < kDraws; ++i) {
    const Vector3 draw = normal3(rng, 0.02);
    covariance += draw * draw.transpose() / (kDraws * 0.02 * 0.02);
  }
  EXPECT_LT((covariance - Matrix3::Identity()).cwiseAbs().maxCoeff(), 0.1);  // five of sqrt(2 / 5000)
}

}  // namespace
}  // namespace snug::identification::internal
