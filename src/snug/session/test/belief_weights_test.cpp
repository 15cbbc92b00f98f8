// Belief as statistics: likelihoods of worlds, what a surprise may do to them, and draws that have the stated spread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "snug/model/test/shortened.hpp"
#include "snug/session/test/believing.hpp"

namespace snug::session {
namespace {

using test::TestBelief;

using Predictions = std::vector<std::vector<std::optional<Pose>>>;

model::Scenario scenario_with(double least_weight) {
  model::Scenario scenario = model::test::shortened(2);
  scenario.belief.least_weight = least_weight;
  scenario.belief.rest = 0.0;
  return scenario;
}

BeliefSettings samples(int count, std::uint64_t seed = 1) {
  BeliefSettings settings;
  settings.samples = count;
  settings.seed = seed;
  return settings;
}

perception::Observation box_seen_at(const Pose& X_WP, const Matrix6& covariance = Matrix6::Zero()) {
  perception::Observation seen;
  seen.seen.push_back({"BOX027", X_WP, covariance, {}, 0.0});
  return seen;
}

/// World w predicted the box `off[w]` m beside where it then is seen.
void surprise(TestBelief& belief, const std::vector<double>& off, const Matrix6& covariance = Matrix6::Zero()) {
  const Pose is = belief.box(0)->X_WP;
  Predictions predicted;
  for (const double x : off) {
    Pose X_WP = is;
    X_WP.p.x() += x;
    predicted.push_back({X_WP, std::nullopt});
  }
  belief.expect(predicted);
  belief.see(box_seen_at(is, covariance));
  belief.weigh(0);
}

double sum_of_samples(const TestBelief& belief) {
  const std::vector<double> weights = belief.weights();
  return std::accumulate(weights.begin() + 1, weights.end(), 0.0);
}

/// exp(-d^2 / (2 s^2)) of the distance, three coordinates counted as one: a third of the exponent.
TEST(Weights, FollowTheLikelihoodOfWhatTheWorldsPredicted) {
  const model::Scenario scenario = scenario_with(0.0);
  TestBelief belief(scenario, "1", samples(3));
  belief.arrives(0);
  const double sigma = scenario.belief.model_error;
  surprise(belief, {0.0, 0.0, sigma, 3.0 * sigma});
  std::vector<double> w = belief.weights();
  EXPECT_NEAR(w[2] / w[1], std::exp(-0.5 * 1.0 / 3.0), 1e-9);
  EXPECT_NEAR(w[3] / w[1], std::exp(-0.5 * 9.0 / 3.0), 1e-9);
  EXPECT_NEAR(sum_of_samples(belief), 3.0, 1e-12);
  surprise(belief, {0.0, sigma, 0.0, 0.0});
  w = belief.weights();
  EXPECT_NEAR(w[2] / w[1], 1.0, 1e-9) << "independent items multiply: both were off by as much, once";
}

TEST(Weights, AnUncertainLookTellsLess) {
  const model::Scenario scenario = scenario_with(0.0);
  const double sigma = scenario.belief.model_error;
  const auto ratio = [&](double deviation) {
    TestBelief belief(scenario, "1", samples(2));
    belief.arrives(0);
    Matrix6 covariance = Matrix6::Zero();
    covariance.topLeftCorner<3, 3>() = deviation * deviation * Matrix3::Identity();
    surprise(belief, {0.0, 0.0, 2.0 * sigma}, covariance);
    return belief.weights()[2] / belief.weights()[1];
  };
  EXPECT_NEAR(ratio(0.0), std::exp(-0.5 * 4.0 / 3.0), 1e-9);
  EXPECT_NEAR(ratio(sigma), std::exp(-0.5 * 2.0 / 3.0), 1e-9) << "twice the variance";
  EXPECT_GT(ratio(10.0 * sigma), 0.98);
}

TEST(Weights, NoMissTellsMoreThanFiveDeviations) {
  const model::Scenario scenario = scenario_with(0.0);
  TestBelief belief(scenario, "1", samples(4));
  belief.arrives(0);
  const double sigma = scenario.belief.model_error;
  const Pose is = belief.box(0)->X_WP;
  Pose at_five = is, far = is;
  at_five.p.x() += 5.0 * sigma;
  far.p.x() += 10.0;
  belief.expect({{is, {}}, {is, {}}, {at_five, {}}, {far, {}}, {std::nullopt, std::nullopt}});
  belief.see(box_seen_at(is));
  belief.weigh(0);
  const std::vector<double> w = belief.weights();
  EXPECT_NEAR(w[2] / w[1], std::exp(-0.5 * 25.0 / 3.0), 1e-9);
  EXPECT_NEAR(w[3], w[2], 1e-12);
  EXPECT_NEAR(w[4], w[2], 1e-12) << "a world that lost the box";
}

TEST(Weights, WhatAllPredictedAlikeChangesNothing) {
  TestBelief belief(scenario_with(0.25), "1", samples(5));
  belief.arrives(0);
  for (const double off : {0.0, 0.003, 0.5}) {
    surprise(belief, std::vector<double>(6, off));
    for (std::size_t w = 1; w < 6; ++w) EXPECT_NEAR(belief.weights()[w], 1.0, 1e-12) << off;
  }
}

TEST(Weights, ManySurprisesRuleOutNoWorld) {
  const model::Scenario scenario = scenario_with(0.25);
  TestBelief belief(scenario, "1", samples(4));
  belief.arrives(0);
  for (int i = 0; i < 200; ++i) {
    surprise(belief, {0.0, 0.0, 0.1, 0.1, 0.1});
    EXPECT_NEAR(sum_of_samples(belief), 4.0, 1e-9);
    const std::vector<double> weights = belief.weights();
    EXPECT_GE(*std::min_element(weights.begin() + 1, weights.end()), 0.25 - 1e-12);
  }
  EXPECT_NEAR(belief.weights()[1], 4.0 - 3.0 * 0.25, 0.05) << "the one that was right has nearly all the rest";
  for (int i = 0; i < 30; ++i) surprise(belief, {0.0, 0.1, 0.0, 0.0, 0.0});
  EXPECT_LT(belief.weights()[1], 0.5) << "it can be wrong later";
}

TEST(Weights, NothingIsLearnedWithoutALookOrWithoutSamples) {
  const model::Scenario scenario = scenario_with(0.25);
  TestBelief unseen(scenario, "1", samples(2));
  unseen.arrives(0);
  Pose elsewhere = unseen.box(0)->X_WP;
  elsewhere.p.x() += 0.1;
  unseen.expect({{unseen.box(0)->X_WP, {}}, {elsewhere, {}}, {unseen.box(0)->X_WP, {}}});
  perception::Observation nothing;
  nothing.not_seen = {"BOX027"};
  unseen.see(nothing);
  unseen.weigh(0);
  EXPECT_EQ(unseen.weights(), (std::vector<double>{1.0, 1.0, 1.0}));
  unseen.weigh(1);  // never came
  EXPECT_EQ(unseen.weights(), (std::vector<double>{1.0, 1.0, 1.0}));
  TestBelief alone(scenario, "1", samples(0));
  alone.arrives(0);
  surprise(alone, {0.1});
  EXPECT_EQ(alone.weights(), std::vector<double>{1.0});
}

/// Poses of a box in the air over forty worlds: mean and spread as the look states; 5 sigma of a variance's estimate.
TEST(BeliefDraws, PosesHaveTheCovarianceOfTheLook) {
  const model::Scenario scenario = scenario_with(0.25);
  constexpr int kWorlds = 60;
  TestBelief belief(scenario, "1", samples(kWorlds));
  belief.arrives(0);
  const Pose X_WP = belief.box(0)->X_WP;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << 4e-6, 1e-6, 0.0, 0.0, 0.0, 1e-4;
  plant::Feedback robot;
  robot.X_WE = scenario.controller.X_WE_start;
  Vector3 mean = Vector3::Zero(), square = Vector3::Zero();
  // The plates of the aligner stop boxes that are drawn into them: over the free bench.
  const Pose free{X_WP.R, Vector3(0.1, 0.5, 0.0 + 0.5 * 0.094)};
  belief.see(box_seen_at(free, covariance));
  const auto rollouts = belief.take_up(robot);
  for (std::size_t w = 1; w < rollouts.size(); ++w) {
    const Pose is = *rollouts[w]->pose_of(model::ItemIndex(0));
    const Vector3 error(is.p.x() - free.p.x(), is.p.y() - free.p.y(), log_rotation(is.R * free.R.transpose()).z());
    mean += error / kWorlds;
    square += error.cwiseAbs2() / kWorlds;
  }
  const double five = 5.0 / std::sqrt(static_cast<double>(kWorlds));
  const Vector3 variance(4e-6, 1e-6, 1e-4);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(mean[i]), five * std::sqrt(variance[i])) << i;
    EXPECT_NEAR(square[i] / variance[i], 1.0, five * std::sqrt(2.0)) << i;
    EXPECT_GT(square[i], 0.3 * variance[i]) << i;
  }
  const Pose nominal = *rollouts[0]->pose_of(model::ItemIndex(0));
  EXPECT_LT((nominal.p - free.p).norm(), 5e-4) << "the nominal world is not drawn";
}

/// Sizes are measured once, at the aligner: sampled worlds have them with the stated deviation, the nominal one as
/// seen.
TEST(BeliefDraws, SizesHaveTheDeviationOfTheMeasurementAndAreMeasuredOnce) {
  const model::Scenario scenario = scenario_with(0.25);
  constexpr int kWorlds = 40;
  TestBelief belief(scenario, "1", samples(kWorlds));
  belief.arrives(0);
  const Vector3 is(0.172, 0.232, 0.095);
  perception::Observation look = box_seen_at(belief.box(0)->X_WP);
  look.seen[0].size = is;
  look.seen[0].size_deviation = 0.0004;
  belief.see(look);
  plant::Feedback robot;
  robot.X_WE = scenario.controller.X_WE_start;
  const auto sizes = [&] {
    std::vector<Vector3> all;
    for (const auto& rollout : belief.take_up(robot)) {
      const model::Scenario& world = rollout->simulation().scenario();
      all.push_back(model::collision_size(world, *model::find_parcel(world, "BOX027")));
    }
    return all;
  };
  const std::vector<Vector3> first = sizes();
  EXPECT_TRUE(first[0].isApprox(is, 1e-12));
  double square = 0.0;
  for (std::size_t w = 1; w < first.size(); ++w) square += (first[w] - is).squaredNorm() / (3.0 * kWorlds);
  // 120 normal draws: their mean square has a deviation of 13 %.
  EXPECT_NEAR(std::sqrt(square), 0.0004, 5.0 * 0.065 * 0.0004);
  look.seen[0].size = 1.02 * is;
  belief.see(look);
  EXPECT_EQ(sizes(), first) << "it was seen without a break";
}

TEST(BeliefDraws, AMeasurementThatCannotBeIsNotTakenForASize) {
  const model::Scenario scenario = scenario_with(0.25);
  TestBelief belief(scenario, "1", samples(1));
  belief.arrives(0);
  perception::Observation look = box_seen_at(belief.box(0)->X_WP);
  look.seen[0].size = Vector3(-1.0, 0.0, 0.1);
  belief.see(look);
  const Vector3 size = model::find_parcel(belief.nominal(), "BOX027")->size;
  const Vector3 was = model::find_parcel(scenario, "BOX027")->size;
  EXPECT_GE((size - 0.5 * was).minCoeff(), -1e-12) << "no box shrinks to less than half";
}

TEST(BeliefDraws, UnknownItemsInALookAreNoItems) {
  TestBelief belief(scenario_with(0.25), "1", samples(1));
  perception::Observation look;
  look.seen.push_back({"BOX999", Pose{}, Matrix6::Zero(), {}, 0.0});
  look.not_seen = {"BOX998"};
  look.missing = {"BOX998"};
  belief.see(look);
  EXPECT_TRUE(belief.expectations().empty());
  EXPECT_FALSE(belief.box(0));
}

TEST(BeliefDraws, WorldsAreTheSeedsAndOthersWithAnotherSeed) {
  const model::Scenario scenario = scenario_with(0.25);
  plant::Feedback robot;
  robot.X_WE = scenario.controller.X_WE_start;
  const auto arrivals = [&](std::uint64_t seed) {
    TestBelief belief(scenario, "1", samples(2, seed));
    belief.arrives(0);
    std::vector<double> x;
    for (const auto& rollout : belief.take_up(robot)) x.push_back(rollout->pose_of(model::ItemIndex(0))->p.x());
    return x;
  };
  const std::vector<double> one = arrivals(1), two = arrivals(2);
  EXPECT_EQ(one, arrivals(1));
  EXPECT_EQ(one[0], two[0]) << "the nominal world is nobody's draw";
  EXPECT_NE(one[1], two[1]);
  EXPECT_NE(one[1], one[2]);
}

}  // namespace
}  // namespace snug::session
