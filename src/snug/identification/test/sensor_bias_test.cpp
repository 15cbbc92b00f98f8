// SensorBias: taken out again as it came in, compared with gravity, and found beside the numbers of the cup.
#include "snug/identification/internal/sensor_bias.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/identification/virtual_experiments.hpp"

namespace snug::identification::internal {
namespace {

const Matrix6 kBiasK = cup::as_matrix(identification::test::kTruth);
const Wrench kBias{Vector3(1.5, -0.8, 2.0), Vector3(0.04, -0.03, 0.02)};

/// Poses whose sensor reads a constant of the gripper's frame too much.
StaticPoses biased_poses(int count, const Wrench& bias_E, std::uint64_t seed) {
  Rng rng = Rng(19).split("bias poses");
  StaticPoses poses = make_static_poses(kBiasK, frames_of({}), count, rng);
  if (seed > 0) {
    Rng noise = Rng(seed).split("bias noise");
    add_noise(poses, {}, noise);
  }
  for (StaticPose& pose : poses.poses) {
    pose.wrench_S->head<3>() += pose.X_ES.R.transpose() * bias_E.force;
    pose.wrench_S->tail<3>() += pose.X_ES.R.transpose() * bias_E.torque;
  }
  return poses;
}

TEST(SensorBias, IsTakenOutAsItCameIn) {
  const StaticPoses clean = biased_poses(12, {}, 0), biased = biased_poses(12, kBias, 0);
  const StaticPoses again = without_bias(biased, kBias);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_GT((*biased.poses[i].wrench_S - *clean.poses[i].wrench_S).norm(), 1.0);
    EXPECT_LT((*again.poses[i].wrench_S - *clean.poses[i].wrench_S).norm(), 1e-12);
    EXPECT_EQ(again.poses[i].X_ES, clean.poses[i].X_ES);
  }
  StaticPoses without_sensor = clean;
  without_sensor.poses[3].wrench_S = {};
  EXPECT_FALSE(without_bias(without_sensor, kBias).poses[3].wrench_S.has_value());
}

TEST(SensorBias, OfExactReadingsIsTheConstantThatWasAdded) {
  const std::optional<SensorBias> bias = compare_with_gravity(biased_poses(20, kBias, 0));
  ASSERT_TRUE(bias);
  EXPECT_TRUE(bias->is_against_gravity);
  EXPECT_LT((bias->bias.force - kBias.force).norm(), 1e-10);
  EXPECT_LT((bias->bias.torque - kBias.torque).norm(), 1e-10);
  EXPECT_LT(bias->misfit, 1e-12);
  EXPECT_LT(compare_with_gravity(biased_poses(20, {}, 0))->statistic, 1e-12);
}

TEST(SensorBias, IsKnownWithTheRootOfThePoses) {
  // Errors are those of readings of equal loads: a hundred say ten times as much as one.
  StaticPoses one = biased_poses(1, kBias, 0);
  StaticPoses many = one;
  for (int i = 1; i < 100; ++i) many.poses.push_back(one.poses.front());
  const SensorBias of_one = *compare_with_gravity(one), of_many = *compare_with_gravity(many);
  EXPECT_NEAR(of_one.error.force.x() / of_many.error.force.x(), 10.0, 1e-9);
  EXPECT_NEAR(of_one.error.torque.z() / of_many.error.torque.z(), 10.0, 1e-9);
  EXPECT_NEAR(of_many.statistic / of_one.statistic, 100.0, 1e-6);
  // 0.3 N of the sensor, and 0.2 degrees of the weight's direction.
  const double weight = one.poses.front().load->mass * 9.81;
  EXPECT_NEAR(of_one.error.force.y(), std::hypot(0.3, 0.0034906585 * weight), 1e-6);
}

TEST(SensorBias, NeedsLoadAndReadingInEachPose) {
  for (const bool of_load : {true, false}) {
    StaticPoses poses = biased_poses(10, kBias, 0);
    if (of_load)
      poses.poses[4].load = {};
    else
      poses.poses[4].wrench_S = {};
    EXPECT_FALSE(compare_with_gravity(poses));
  }
}

TEST(SensorBias, StatisticOfNoBiasIsThatOfChance) {
  // Chi-square of six: mean 6, variance 12; over 200 sets the mean is known to 0.25, and misfits are about 1.
  double mean = 0.0, misfit = 0.0;
  constexpr int kSets = 200;
  for (std::uint64_t set = 1; set <= kSets; ++set) {
    const SensorBias bias = *compare_with_gravity(biased_poses(15, {}, set));
    mean += bias.statistic / kSets;
    misfit += bias.misfit / kSets;
  }
  // Turns about the weight itself move no force: variances are said a little too large (by 5 % with these loads).
  EXPECT_NEAR(mean, 6.0, 1.2);
  EXPECT_NEAR(misfit, 1.0, 0.1);
}

TEST(SensorBias, OfWrongLoadsIsSaidToBeNoConstant) {
  StaticPoses poses = biased_poses(30, {}, 1);
  for (StaticPose& pose : poses.poses) pose.load->mass *= 1.3;  // loads differ, and with them what is missing
  EXPECT_GT(compare_with_gravity(poses)->misfit, 5.0);
}

TEST(BiasStep, FindsASmallBiasInOneStepFromTheRightCup) {
  const Wrench small{0.05 * kBias.force, 0.05 * kBias.torque};
  const StaticPoses poses = biased_poses(60, small, 0);
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  const BiasStep step = step_bias(make_balances(poses, WrenchSource::Sensor), std::vector<double>(60, 1.0), kBiasK,
                                  noise, poses.frames, form_of(StiffnessForm::Symmetric));
  // Gauss and Newton from there: what is left is of second order in 0.1 N.
  EXPECT_LT((step.bias - as_vector(small)).cwiseQuotient(step.error).cwiseAbs().maxCoeff(), 0.02);
}

TEST(BiasStep, LeavesOutPosesOfNoWeight) {
  StaticPoses poses = biased_poses(40, {}, 3);
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  const Form& form = form_of(StiffnessForm::Symmetric);
  std::vector<double> weight(40, 1.0);
  weight[7] = 0.0;
  const BiasStep before =
      step_bias(make_balances(poses, WrenchSource::Sensor), weight, kBiasK, noise, poses.frames, form);
  poses.poses[7].wrench_S->head<3>() += Vector3(100.0, 0.0, 0.0);
  const BiasStep after =
      step_bias(make_balances(poses, WrenchSource::Sensor), weight, kBiasK, noise, poses.frames, form);
  EXPECT_EQ(before.bias, after.bias);
  EXPECT_EQ(before.covariance, after.covariance);
}

TEST(BiasStep, ErrorIsTheScatterOverDrawsOfTheNoise) {
  constexpr int kSets = 150;
  const Form& form = form_of(StiffnessForm::Symmetric);
  Vector6 square = Vector6::Zero();
  for (std::uint64_t set = 1; set <= kSets; ++set) {
    const StaticPoses poses = biased_poses(40, {}, 500 + set);
    const BiasStep step = step_bias(make_balances(poses, WrenchSource::Sensor), std::vector<double>(40, 1.0), kBiasK,
                                    carry_noise({}, poses.frames), poses.frames, form);
    square += step.bias.cwiseQuotient(step.error).cwiseAbs2() / kSets;
  }
  // A variance of 150 draws is known to 12 %: four of them, and the second order of the noise.
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(square[i], 1.0, 0.5) << i;
}

}  // namespace
}  // namespace snug::identification::internal
