// The compliance fit: planted numbers, what weights and order do, honest covariance, unknown directions, odd poses.
#include "snug/identification/internal/compliance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

const Matrix6 kFitK = cup::as_matrix(identification::test::kTruth);
const Matrix6 kFitPrior = cup::as_matrix(model::CupParams{}.stiffness);

StaticPoses fit_poses(int count, std::uint64_t seed = 0) {
  Rng rng = Rng(15).split("compliance poses");
  StaticPoses poses = make_static_poses(kFitK, frames_of({}), count, rng);
  if (seed == 0) return poses;
  Rng noise = Rng(seed).split("compliance noise");
  add_noise(poses, {}, noise);
  return poses;
}

LinearEstimate fit_of(const StaticPoses& poses, std::vector<double> weight = {},
                      StiffnessForm form = StiffnessForm::Symmetric) {
  if (weight.empty()) weight.assign(poses.poses.size(), 1.0);
  return fit_compliance(make_compliance_poses(make_balances(poses, WrenchSource::Sensor)), weight,
                        carry_noise(poses.noise, poses.frames), form_of(form), kFitPrior);
}

/// Numbers of the compliance that was planted.
Eigen::VectorXd planted() { return form_of(StiffnessForm::Symmetric).numbers_of(inverse(kFitK)); }

TEST(CompliancePoses, AreLinearInTheCompliance) {
  for (const WrenchSource source : {WrenchSource::Sensor, WrenchSource::Gravity})
    for (const CompliancePose& pose : make_compliance_poses(make_balances(fit_poses(20), source)))
      EXPECT_LT((inverse(kFitK) * pose.g - pose.e).norm(), 1e-9 * (1.0 + pose.e.norm()));
}

TEST(CompliancePoses, KnowHowTheyChangeWithTheWrench) {
  std::vector<Balance> balances = make_balances(fit_poses(5), WrenchSource::Sensor);
  const std::vector<CompliancePose> at = make_compliance_poses(balances);
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<Balance> more = balances;
    for (Balance& balance : more) balance.wrench_S1[axis] += 1.0;
    const std::vector<CompliancePose> there = make_compliance_poses(more);
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_LT((there[i].g - at[i].g - at[i].g_by_wrench.col(axis)).norm(), 1e-9);  // g is linear in it
      EXPECT_EQ(there[i].e, at[i].e);
    }
  }
}

TEST(ComplianceFit, OfExactPosesIsExact) {
  StaticPoses poses = fit_poses(40);
  poses.noise = {0.0, 0.0, 0.0, 0.0};
  const LinearEstimate fit = fit_of(poses);
  EXPECT_LT((fit.theta - planted()).cwiseQuotient(planted()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(fit.unknown.cols(), 0);
}

TEST(ComplianceFit, LeavesOutPosesOfNoWeightAndAsksForNoOrder) {
  const StaticPoses poses = fit_poses(50, 1);
  std::vector<double> weight(50, 1.0);
  StaticPoses kept = poses;
  kept.poses.clear();
  for (std::size_t i = 0; i < 50; ++i) {
    if (i % 7 == 3)
      weight[i] = 0.0;
    else
      kept.poses.push_back(poses.poses[i]);
  }
  const LinearEstimate weighted = fit_of(poses, weight), without = fit_of(kept);
  EXPECT_EQ(weighted.theta, without.theta);
  EXPECT_EQ(weighted.covariance, without.covariance);
  StaticPoses backwards = kept;
  std::ranges::reverse(backwards.poses);
  // Sums in another order: rounding only.
  EXPECT_LT((fit_of(backwards).theta - without.theta).cwiseQuotient(without.theta).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ComplianceFit, OfTheSamePosesTwiceHasHalfTheVariance) {
  const StaticPoses once = fit_poses(60, 2);
  StaticPoses twice = once;
  twice.poses.insert(twice.poses.end(), once.poses.begin(), once.poses.end());
  const LinearEstimate one = fit_of(once), two = fit_of(twice);
  // But for the prior, a thousand times as wide as what is known.
  EXPECT_LT((two.theta - one.theta).cwiseQuotient(one.theta).cwiseAbs().maxCoeff(), 1e-4);
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(two.covariance(i, i) / one.covariance(i, i), 0.5, 0.01);
}

TEST(ComplianceFit, ScalesWithTheForces) {
  // Loads and their noise ten times as large on a cup ten times as stiff: the same deformations, a tenth of C.
  const StaticPoses poses = fit_poses(40, 3);
  StaticPoses strong = poses;
  strong.noise.force *= 10.0;
  strong.noise.torque *= 10.0;
  for (StaticPose& pose : strong.poses) *pose.wrench_S *= 10.0;
  const std::vector<double> weight(40, 1.0);
  const LinearEstimate fit =
      fit_compliance(make_compliance_poses(make_balances(strong, WrenchSource::Sensor)), weight,
                     carry_noise(strong.noise, strong.frames), form_of(StiffnessForm::Symmetric), 10.0 * kFitPrior);
  EXPECT_LT((10.0 * fit.theta - fit_of(poses).theta).cwiseQuotient(planted()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ComplianceFit, CovarianceIsTheScatterOverDrawsOfTheNoise) {
  constexpr int kSets = 300;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(5), square = mean, said = mean;
  for (std::uint64_t set = 1; set <= kSets; ++set) {
    const LinearEstimate fit = fit_of(fit_poses(60, 1000 + set));
    const Eigen::VectorXd off = fit.theta - planted();
    mean += off / kSets;
    square += off.cwiseAbs2() / kSets;
    said += fit.covariance.diagonal() / kSets;
  }
  for (Eigen::Index i = 0; i < 5; ++i) {
    SCOPED_TRACE(form_of(StiffnessForm::Symmetric).numbers[static_cast<std::size_t>(i)].name);
    // Variances of 300 draws are known to 8 %: four of them; means to a 17th of a deviation.
    EXPECT_NEAR(square[i] / said[i], 1.0, 0.33);
    EXPECT_LT(std::abs(mean[i]), 4.5 * std::sqrt(said[i] / kSets));
  }
}

TEST(ComplianceFit, KeepsDirectionsThatNothingTellsAtThePrior) {
  // Boxes that hang straight down: nothing but the axial compliance is loaded.
  StaticPoses poses = fit_poses(30);
  for (std::size_t i = 0; i < 30; ++i) {
    const double weight = 4.0 + 0.5 * static_cast<double>(i);
    poses.poses[i].X_ES = {Matrix3::Identity(),
                           poses.frames.X_ES2.p + Vector3(0.0, 0.0, weight / 5500.0) - poses.frames.X_SS1.p};
    poses.poses[i].wrench_S = (Vector6() << 0.0, 0.0, -weight, 0.0, 0.0, 0.0).finished();
  }
  const LinearEstimate fit = fit_of(poses);
  const Eigen::VectorXd prior = form_of(StiffnessForm::Symmetric).numbers_of(inverse(kFitPrior));
  EXPECT_EQ(fit.unknown.cols(), 4);
  for (const Eigen::Index i : {0, 2, 3, 4}) {
    EXPECT_NEAR(fit.theta[i], prior[i], 1e-6 * std::abs(prior[i]) + 1e-12) << i;
    EXPECT_GT(std::sqrt(fit.covariance(i, i)), 100.0 * std::abs(prior[i])) << i;
  }
  // Noise of 0.3 N is thought to be in the readings, and is not: what it would add to their squares is taken out.
  double square = 0.0;
  for (const StaticPose& pose : poses.poses) square += pose.wrench_S->squaredNorm() / 30.0;
  EXPECT_NEAR(1.0 / fit.theta[1], 5500.0 * (1.0 - 0.09 / square), 0.1);
}

TEST(ComplianceFit, OfTwentyOneNumbersAgreesWithThatOfFiveOnASymmetricCup) {
  const StaticPoses poses = fit_poses(200, 4);
  const LinearEstimate full = fit_of(poses, {}, StiffnessForm::Full);
  ASSERT_EQ(full.theta.size(), 21);
  const Form& form = form_of(StiffnessForm::Full);
  const Eigen::VectorXd truth = form.numbers_of(inverse(kFitK));
  int far = 0;
  for (Eigen::Index i = 0; i < 21; ++i)
    far += std::abs(full.theta[i] - truth[i]) > 3.0 * std::sqrt(full.covariance(i, i)) ? 1 : 0;
  EXPECT_LE(far, 1);  // of 21, at three deviations: 0.06 are expected
}

TEST(OddPoses, AreThoseThatDoNotBelong) {
  StaticPoses poses = fit_poses(80, 5);
  const NoiseAtS1 noise = carry_noise(poses.noise, poses.frames);
  const auto odd = [&] {
    return find_odd_poses(make_compliance_poses(make_balances(poses, WrenchSource::Sensor)), noise,
                          form_of(StiffnessForm::Symmetric), kFitPrior);
  };
  EXPECT_TRUE(odd().empty());
  poses.poses[11].X_ES.p.y() += 0.01;
  poses.poses[42].wrench_S->head<3>() += Vector3(0.0, 50.0, 0.0);
  EXPECT_EQ(odd(), (std::vector<std::size_t>{11, 42}));
  // A fifth of the poses, each wrong in its own way, is not called the rule.
  for (std::size_t i = 0; i < 80; i += 5) {
    const double angle = 2.4 * static_cast<double>(i);
    poses.poses[i].X_ES.p += 0.01 * Vector3(std::sin(angle), std::cos(angle), 0.0);
  }
  const std::vector<std::size_t> many = odd();
  for (std::size_t i = 0; i < 80; i += 5) EXPECT_TRUE(std::ranges::find(many, i) != many.end()) << i;
  EXPECT_LE(many.size(), 80U / 5U + 3U);
}

TEST(OddPoses, OfExactPosesAreNone) {
  StaticPoses poses = fit_poses(40);
  const NoiseAtS1 noise = carry_noise({}, poses.frames);
  // Residuals are rounding: their scatter is no measure of anything.
  EXPECT_TRUE(find_odd_poses(make_compliance_poses(make_balances(poses, WrenchSource::Sensor)), noise,
                             form_of(StiffnessForm::Symmetric), kFitPrior)
                  .empty());
}

}  // namespace
}  // namespace snug::identification::internal
