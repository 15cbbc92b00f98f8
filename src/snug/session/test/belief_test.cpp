// Belief: what is seen replaces what was drawn, sizes are learned, and worlds that predict badly lose weight.
#include "snug/session/test/believing.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "snug/model/test/shortened.hpp"

namespace snug::session {
namespace {

using test::TestBelief;

BeliefSettings quick() {
  BeliefSettings settings;
  settings.samples = 4;
  return settings;
}

plant::Feedback at_start(const model::Scenario& scenario) {
  plant::Feedback robot;
  robot.X_WE = scenario.controller.X_WE_start;
  return robot;
}

perception::Observation seen_at(const Pose& X_WP, std::optional<Vector3> size = {}) {
  perception::Observation seen;
  seen.seen.push_back({"BOX027", X_WP, Matrix6::Zero(), size, 0.0});
  return seen;
}

/// Three items of the demonstrator, the first at the aligner.
struct BeliefOfOneBox : testing::Test {
  BeliefOfOneBox() { belief.arrives(0); }
  const model::Scenario scenario = model::test::shortened(3);
  TestBelief belief{scenario, "1", quick()};
};

TEST_F(BeliefOfOneBox, EveryWorldHasABoxWhereItWasSeen) {
  const Pose nominal = belief.box(0)->X_WP;
  const auto before = belief.take_up(at_start(scenario));
  EXPECT_GT((before[1]->pose_of(model::ItemIndex(0))->p - before[0]->pose_of(model::ItemIndex(0))->p).norm(), 1e-4)
      << "not seen: each draws its own";
  Pose seen = nominal;
  seen.p += belief.nominal().aligner->X_WA.R * Vector3(0.002, 0.001, 0.0);
  belief.see(seen_at(seen));
  for (const auto& rollout : belief.take_up(at_start(scenario))) {
    EXPECT_LT((rollout->pose_of(model::ItemIndex(0))->p - seen.p).head<2>().norm(), 1e-3);
  }
}

TEST_F(BeliefOfOneBox, ErrorsThatPosesHaveInCommonLeaveWhatIsBetweenBoxesAsItWasSeen) {
  belief.arrives(1);
  perception::CommonError common = perception::CommonError::Zero();
  common.topLeftCorner<3, 3>() = 0.003 * Matrix3::Identity();
  perception::Observation seen;
  for (const int item : {0, 1}) {
    const Pose X_WP{Matrix3::Identity(), Vector3(0.0, 0.4 * item, 30.0)};  // in the air, away from everything
    seen.seen.push_back(
        {belief.now().items[static_cast<std::size_t>(item)].id, X_WP, common * common.transpose(), {}, 0.0, common});
  }
  std::vector<Vector3> first;
  for (int look = 0; look < 2; ++look) {
    belief.see(seen);
    const auto worlds = belief.take_up(at_start(scenario));
    for (std::size_t w = 0; w < worlds.size(); ++w) {
      const Vector3 a = worlds[w]->pose_of(model::ItemIndex(0))->p, b = worlds[w]->pose_of(model::ItemIndex(1))->p;
      EXPECT_LT((b - a - Vector3(0.0, 0.4, 0.0)).norm(), 1e-9) << w;
      if (look == 0) first.push_back(a);
      EXPECT_EQ(a, first[w]) << "the camera is where it was";
      if (w > 0) {
        EXPECT_GT((a - first[w - 1]).norm(), 1e-4) << "each world has its own";
      }
    }
  }
}

TEST_F(BeliefOfOneBox, WhatDoesNotStayWhereItWasSeenHasFallenBeforeAnythingIsRehearsed) {
  Pose seen = belief.box(0)->X_WP;
  seen.p.z() += 1.0;
  belief.see(seen_at(seen));
  for (const auto& rollout : belief.take_up(at_start(scenario))) {
    const Vector3 p = rollout->pose_of(model::ItemIndex(0))->p;
    EXPECT_LT(p.z(), seen.p.z() - 0.5);
    const motion::Program still = {
        "still", {motion::make_waypoint(motion::MotionClass::Home, {}, rollout->state().controller.command.X_WE)}};
    (void)rollout->settle(still, 0.5);
    EXPECT_LT((rollout->pose_of(model::ItemIndex(0))->p - p).norm(), 1e-3);
  }
}

TEST_F(BeliefOfOneBox, SizesAreLearnedByEveryWorld) {
  const Vector3 is = Vector3(0.1716, 0.2371, 0.0931);
  belief.see(seen_at(belief.box(0)->X_WP, is));
  for (const auto& rollout : belief.take_up(at_start(scenario))) {
    const model::Scenario& world = rollout->simulation().scenario();
    EXPECT_TRUE(model::collision_size(world, *model::find_parcel(world, "BOX027")).isApprox(is, 1e-12));
  }
}

TEST_F(BeliefOfOneBox, BoxesThatTurnOutStifferAreSoInEveryWorldAndNeverBeyondTheLimit) {
  const auto stiffness = [&] {
    std::vector<double> all;
    for (const auto& rollout : belief.take_up(at_start(scenario))) {
      for (const model::ContactPair& pair : rollout->simulation().scenario().contact_pairs) {
        if (pair.params.stiffness) all.push_back(*pair.params.stiffness);
      }
    }
    return all;
  };
  const std::vector<double> before = stiffness();
  ASSERT_FALSE(before.empty());
  for (const double factor : {scenario.belief.stiffer, scenario.belief.stiffest, scenario.belief.stiffest}) {
    belief.stiffen();
    const std::vector<double> now = stiffness();
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_NEAR(now[i], factor * before[i], 1e-9 * now[i]);
  }
}

TEST_F(BeliefOfOneBox, ForgetsWhatIsTakenAway) {
  EXPECT_EQ(belief.expectations().size(), 1U);
  belief.forget(0);
  EXPECT_TRUE(belief.expectations().empty());
  for (const auto& rollout : belief.take_up(at_start(scenario))) EXPECT_FALSE(rollout->pose_of(model::ItemIndex(0)));
}

TEST_F(BeliefOfOneBox, WorldsThatPredictedBadlyLoseWeightButNotAll) {
  const Pose is = belief.box(0)->X_WP;
  std::vector<std::vector<std::optional<Pose>>> predicted(5, std::vector<std::optional<Pose>>(3));
  for (std::size_t w = 0; w < 5; ++w) {
    Pose X_WP = is;
    X_WP.p.x() += 0.004 * static_cast<double>(w);
    predicted[w][0] = X_WP;
  }
  belief.expect(predicted);
  belief.see(seen_at(is));
  belief.weigh(0);
  const std::vector<double> weights = belief.weights();
  for (std::size_t w = 2; w < 5; ++w) EXPECT_LT(weights[w], weights[w - 1]);
  EXPECT_GT(weights[4], 0.0);
  EXPECT_NEAR(std::accumulate(weights.begin() + 1, weights.end(), 0.0), 4.0, 1e-12);
}

TEST_F(BeliefOfOneBox, WhatIsNotSeenIsBelievedToBeWhereItWasPredicted) {
  Pose there = belief.box(0)->X_WP;
  there.p.x() += 0.1;
  belief.expect(std::vector<std::vector<std::optional<Pose>>>(5, {there, std::nullopt, std::nullopt}));
  perception::Observation nothing;
  nothing.not_seen = {"BOX027"};
  belief.see(nothing);
  EXPECT_EQ(belief.box(0)->X_WP, there);
  EXPECT_FALSE(belief.box(0)->was_seen);
  EXPECT_GT(belief.box(0)->covariance(0, 0), 0.0);
}

TEST_F(BeliefOfOneBox, APredictionCountsAtTheFirstLookAlone) {
  const Pose here = belief.box(0)->X_WP;
  Pose there = here;
  there.p.x() += 0.1;
  belief.expect(std::vector<std::vector<std::optional<Pose>>>(5, {there, std::nullopt, std::nullopt}));
  belief.see(seen_at(here));
  perception::Observation nothing;
  nothing.not_seen = {"BOX027"};
  belief.see(nothing);
  EXPECT_EQ(belief.box(0)->X_WP, here) << "it was seen after that motion, and nothing has moved since";
}

TEST_F(BeliefOfOneBox, AMotionThatWasBrokenOffPredictsNothing) {
  const Pose here = belief.box(0)->X_WP;
  Pose there = here;
  there.p.x() += 0.1;
  belief.expect_on_the_way(0, there);
  belief.doubt_prediction();
  EXPECT_EQ(belief.expectations()[0].X_WP, there) << "it is looked for there all the same";
  perception::Observation nothing;
  nothing.not_seen = {"BOX027"};
  belief.see(nothing);
  EXPECT_EQ(belief.box(0)->X_WP, here);
  EXPECT_FALSE(belief.box(0)->was_seen);
}

TEST_F(BeliefOfOneBox, ExpectsAPredictionUntilItHasLookedAndThenWhatItSaw) {
  const Pose here = belief.box(0)->X_WP;
  EXPECT_EQ(belief.expectations()[0].X_WP, here);
  Pose there = here;
  there.p.x() += 0.1;
  belief.expect(std::vector<std::vector<std::optional<Pose>>>(5, {there, std::nullopt, std::nullopt}));
  EXPECT_EQ(belief.expectations()[0].X_WP, there);
  Pose seen = there;
  seen.p.y() += 0.01;
  belief.see(seen_at(seen));
  EXPECT_EQ(belief.expectations()[0].X_WP, seen);
}

TEST_F(BeliefOfOneBox, WhatIsMissingIsBelievedToBeNowhere) {
  perception::Observation empty;
  empty.not_seen = empty.missing = {"BOX027"};
  belief.see(empty);
  EXPECT_FALSE(belief.box(0).has_value());
  EXPECT_TRUE(belief.expectations().empty());
}

perception::Observation with_object(const model::Scenario& scenario) {
  perception::Observation seen;
  const model::Container& container = *model::find_container(scenario, scenario.target);
  const Pose X_WP = container.X_WT * Pose{Matrix3::Identity(), Vector3(0.05, -0.1, 0.03)};
  seen.obstacles = {{perception::columns_of_box(X_WP, {0.09, 0.07, 0.06}), 0.0005}};
  return seen;
}

TEST_F(BeliefOfOneBox, EveryWorldHasBodiesForAnObstacleAndNoneWhenItIsGone) {
  const std::size_t before = belief.nominal().bodies.size();
  const perception::Observation look = with_object(scenario);
  EXPECT_TRUE(belief.has_new_obstacle(look));
  belief.see(look);
  EXPECT_FALSE(belief.has_new_obstacle(look));
  const double floor = model::find_container(scenario, scenario.target)->X_WT.p.z();
  for (const auto& rollout : belief.take_up(at_start(scenario))) {
    const auto& bodies = rollout->simulation().scenario().bodies;
    ASSERT_EQ(bodies.size(), before + 1);
    const model::Body& body = bodies.back();
    EXPECT_EQ(body.kind, model::BodyKind::Static);
    const double half = std::get<geometry::Box>(body.shapes.front().shape).half.z();
    EXPECT_NEAR(body.X_WB.p.z() + half, floor + 0.06 + 0.001, 1e-9) << "two deviations over it";
  }
  perception::Observation empty;
  empty.obstacles.emplace();
  belief.see(empty);
  for (const auto& rollout : belief.take_up(at_start(scenario))) {
    EXPECT_EQ(rollout->simulation().scenario().bodies.size(), before);
  }
}

TEST_F(BeliefOfOneBox, AnObstacleOfOneBadPictureIsDropped) {
  perception::Observation look = with_object(scenario), before;
  before.obstacles.emplace();
  belief.drop_unconfirmed(look, before);
  EXPECT_TRUE(look.obstacles->empty());
  look = with_object(scenario);
  belief.drop_unconfirmed(look, look);
  EXPECT_EQ(look.obstacles->size(), 1U);
  belief.see(look);
  belief.drop_unconfirmed(look, before);
  EXPECT_EQ(look.obstacles->size(), 1U) << "known";
}

TEST(Belief, IsTheSameWithAnyNumberOfThreads) {
  const model::Scenario scenario = model::test::shortened(3);
  TestBelief one(scenario, "1", quick()), two(scenario, "1", quick());
  two.threads = 2;
  for (TestBelief* belief : {&one, &two}) belief->arrives(0);
  const auto a = one.take_up(at_start(scenario));
  const auto b = two.take_up(at_start(scenario));
  for (std::size_t w = 0; w < a.size(); ++w) {
    EXPECT_EQ(a[w]->simulation().hash(a[w]->state()), b[w]->simulation().hash(b[w]->state())) << w;
  }
}

}  // namespace
}  // namespace snug::session
