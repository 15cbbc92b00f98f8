// Rehearsal: what it says of one way to one place, limit by limit, and how often that holds in worlds that are known.
#include "snug/planning/rehearsal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "snug/cell/joint_pace.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/session/test/believing.hpp"

namespace snug::session {
namespace {

using planning::Attempt;
using planning::AttemptFailure;
using test::TestBelief;

/// BOX027 at the aligner, to be put down on the empty floor.
class RehearsalOfOneBox : public testing::Test {
 protected:
  explicit RehearsalOfOneBox(model::Scenario scenario = model::test::shortened(2)) : scenario_(std::move(scenario)) {
    cell_ = planning::make_cell_plan(scenario_, motion::FastTracking{});
    cell_.reaches = {};  // everywhere
  }
  void believe(int samples, std::uint64_t seed = 1) {
    BeliefSettings settings;
    settings.samples = samples;
    settings.seed = seed;
    settings.simulation.tracking = motion::FastTracking{};
    belief_ = std::make_unique<TestBelief>(scenario_, "1", settings);
    belief_->arrives(0);
  }
  [[nodiscard]] packing::Candidate candidate(const Vector3& p_TP = Vector3(0.0, 0.0, 0.047)) const {
    packing::Candidate one;
    one.placement.item = "BOX027";
    const Matrix3 R_AP = scenario_.aligner->X_WA.R.transpose() * belief_->box(0)->X_WP.R;
    one.placement.orientation = packing::nearest_orientation(R_AP);
    one.placement.X_TP = {packing::rotation(one.placement.orientation), p_TP};
    return one;
  }
  [[nodiscard]] Attempt attempt(const packing::Candidate& where, int threads = 1,
                                const skills::Insertion& insertion = {}) {
    plant::Feedback robot;
    robot.X_WE = scenario_.controller.X_WE_start;
    const auto rollouts = belief_->take_up(robot);
    planning::Rehearsal rehearsal(belief_->now(), cell_, rollouts, threads,
                                  {model::ItemIndex(0), belief_->box(0)->X_WP, planning::Location::Aligner, {}});
    return rehearsal.attempt(where, insertion, 0.0);
  }

  model::Scenario scenario_;
  planning::CellPlan cell_;
  std::unique_ptr<TestBelief> belief_;
};

TEST_F(RehearsalOfOneBox, SucceedsOnAnEmptyFloorWithForcesOfItsWeight) {
  believe(2);
  const Attempt one = attempt(candidate());
  EXPECT_TRUE(one.succeeded) << one.text;
  EXPECT_EQ(one.failure, AttemptFailure::None);
  EXPECT_TRUE(one.text.empty());
  EXPECT_EQ(one.samples, 2);
  EXPECT_EQ(one.success_rate, 1.0);
  const double weight = 9.81 * model::find_parcel(scenario_, "BOX027")->inertia.mass;
  EXPECT_GT(one.nominal.force, weight) << "it was lifted";
  EXPECT_LT(one.nominal.force, cell_.limits.force);
  EXPECT_EQ(one.nominal.displacement, 0.0) << "there is no other box";
  ASSERT_EQ(one.ends.size(), 3U) << "world by world";
  const Pose X_WT = model::find_container(scenario_, scenario_.target)->X_WT;
  for (const auto& end : one.ends) {
    ASSERT_TRUE(end[0]);
    EXPECT_LT((X_WT.inverse() * end[0]->p - one.planned.X_TP.p).norm(), cell_.limits.position);
    EXPECT_FALSE(end[1]) << "it has not come";
  }
}

/// Each limit alone set to what nothing keeps: the attempt fails for that reason and says so.
TEST_F(RehearsalOfOneBox, FailsByEachLimitForItsOwnReason) {
  believe(0);
  const settings::PlaceLimits usual = cell_.limits;
  const auto failure = [&] {
    const Attempt one = attempt(candidate());
    EXPECT_FALSE(one.succeeded);
    EXPECT_FALSE(one.text.empty());
    EXPECT_EQ(one.samples, 0) << "what fails in the nominal world is not sampled";
    cell_.limits = usual;
    return one.failure;
  };
  cell_.limits.position = 0.0;
  EXPECT_EQ(failure(), AttemptFailure::OffPlace);
  cell_.limits.tilt = 0.0;
  EXPECT_EQ(failure(), AttemptFailure::Tilted);
  cell_.limits.force = 1.0;
  EXPECT_EQ(failure(), AttemptFailure::Rollout);
  cell_.limits.hold_factor = 1e6;
  EXPECT_EQ(failure(), AttemptFailure::HoldMargin);
}

TEST_F(RehearsalOfOneBox, ABoxThatIsLetGoOverTheRimSticksOutOrIsBeside) {
  believe(0);
  const Vector3 inner = model::find_container(scenario_, scenario_.target)->inner_size;
  const Attempt beside = attempt(candidate(Vector3(0.0, 0.5 * inner.y() + 0.2, inner.z() + 0.1)));
  EXPECT_EQ(beside.failure, AttemptFailure::SticksOut);
  EXPECT_NE(beside.text.find("beside the container"), std::string::npos) << beside.text;
}

TEST_F(RehearsalOfOneBox, ABoxThatIsPushedAsideIsFoundAndCounted) {
  believe(0);
  belief_->arrives(1);
  perception::Observation seen;
  const Pose X_WT = model::find_container(scenario_, scenario_.target)->X_WT;
  const packing::Candidate where = candidate();
  seen.seen.push_back({"BOX027", belief_->box(0)->X_WP, Matrix6::Zero(), {}, 0.0});
  Pose other = X_WT * where.placement.X_TP;
  other.p.x() += 0.19;  // its edge lies under the place
  seen.seen.push_back({"BOX028", other, Matrix6::Zero(), {}, 0.0});
  belief_->see(seen);
  cell_.limits.displacement = 0.0;
  cell_.limits.position = 1.0;
  cell_.limits.tilt = 3.0;
  const Attempt one = attempt(where);
  EXPECT_FALSE(one.succeeded);
  EXPECT_GT(one.nominal.displacement, 0.0);
}

TEST_F(RehearsalOfOneBox, ItsResultDoesNotDependOnThreads) {
  believe(3);
  const Attempt one = attempt(candidate(), 1), two = attempt(candidate(), 2);
  EXPECT_EQ(one.program, two.program);
  EXPECT_EQ(one.ends, two.ends);
  EXPECT_EQ(one.predicted.force, two.predicted.force);
}

/// BOX015, 201 mm high, 97 mm wide.
class RehearsalOfATallBox : public RehearsalOfOneBox {
 protected:
  static model::Scenario tall() {
    model::Scenario scenario = model::test::shortened(6);
    scenario.sequences[0].items.erase(scenario.sequences[0].items.begin(), scenario.sequences[0].items.end() - 1);
    return scenario;
  }
  RehearsalOfATallBox() : RehearsalOfOneBox(tall()) {}
};

/// Pushed by an upright tool it would be turned about the cup, meet the walls with its upper edges and fall back flat.
TEST_F(RehearsalOfATallBox, ABoxThatIsPushedIntoACornerStandsAgainstBothWalls) {
  believe(2);
  ASSERT_EQ(belief_->now().items[0].id, "BOX015");
  const Vector3 inner = model::find_container(scenario_, scenario_.target)->inner_size;
  packing::Candidate where = candidate();
  where.placement.item = "BOX015";
  const Vector3 size = model::collision_size(scenario_, *model::find_parcel(scenario_, "BOX015"));
  const Vector3 half = 0.5 * (where.placement.X_TP.R.cwiseAbs() * size);
  const Vector3 contact(half.x() - 0.5 * inner.x(), half.y() - 0.5 * inner.y(), half.z());
  // As it is planned: smaller than measured by scenario_.packing.planned_interference.
  const double inside = 0.5 * scenario_.packing.planned_interference;
  where.placement.X_TP.p = contact - Vector3(inside, inside, 0.0);
  const Attempt one = attempt(where, 1,
                              {.skill = skills::InsertionSkill::SlideToContact,
                               .come_from_T = Vector3(0.01, 0.01, 0.0),
                               .overtravel_T = Vector3(-0.005, -0.005, 0.0)});
  ASSERT_TRUE(one.succeeded) << one.text;
  const Pose X_WT = model::find_container(scenario_, scenario_.target)->X_WT;
  for (const auto& end : one.ends) {
    ASSERT_TRUE(end[0]);
    const Pose X_TP = X_WT.inverse() * *end[0];
    EXPECT_LT((X_TP.p - contact).head<2>().norm(), 0.0011);
  }
}

/// Boxes are not seen: each world has its own arrival, drawn within 12 mm, and picks where the nominal one does. So a
/// box ends as far from its place as it stood from where it was thought to stand, and succeeds when that is within the
/// limit: a circle in a square.
class RehearsalOfUnseenBoxes : public RehearsalOfOneBox {
 protected:
  static model::Scenario unseen() {
    model::Scenario scenario = model::test::shortened(2);
    scenario.uncertainty = model::no_uncertainty();
    scenario.uncertainty.position = 0.012;
    scenario.rehearsal.least_rate = 0.0;
    scenario.rehearsal.first_samples = 0;
    return scenario;
  }
  RehearsalOfUnseenBoxes() : RehearsalOfOneBox(unseen()) {}
};

TEST_F(RehearsalOfUnseenBoxes, PredictsTheFractionOfWorldsInWhichItSucceeds) {
  constexpr int kWorlds = 16;
  believe(kWorlds, 3);
  cell_.limits.position = 0.009;
  const Attempt one = attempt(candidate());
  ASSERT_TRUE(one.succeeded) << one.text;
  ASSERT_EQ(one.samples, kWorlds);
  const Pose X_WT = model::find_container(scenario_, scenario_.target)->X_WT;
  int within = 0;
  plant::Feedback robot;
  robot.X_WE = scenario_.controller.X_WE_start;
  const auto rollouts = belief_->take_up(robot);
  const Vector3 nominal = rollouts[0]->pose_of(model::ItemIndex(0))->p;
  for (std::size_t w = 1; w < one.ends.size(); ++w) {
    const double off = (X_WT.inverse() * one.ends[w][0]->p - one.planned.X_TP.p).head<2>().norm();
    const double stood_off = (rollouts[w]->pose_of(model::ItemIndex(0))->p - nominal).head<2>().norm();
    EXPECT_NEAR(off, stood_off, 0.004) << "the cup bends under a box that it holds beside its middle";
    within += off <= cell_.limits.position ? 1 : 0;
  }
  EXPECT_GT(within, 0);
  EXPECT_LT(within, kWorlds);
  EXPECT_NEAR(one.success_rate, static_cast<double>(within) / kWorlds, 1e-12);
  EXPECT_EQ(one.failure, AttemptFailure::OffPlace) << "of the first that failed";
  // pi r^2 / (2 h)^2 of the worlds; of 16 within three deviations.
  const double chance = 3.14159265358979 * 0.009 * 0.009 / (0.024 * 0.024);
  EXPECT_NEAR(one.success_rate, chance, 3.0 * std::sqrt(chance * (1.0 - chance) / kWorlds));
}

TEST_F(RehearsalOfUnseenBoxes, WorldsCountByTheirWeight) {
  believe(4, 3);
  cell_.limits.position = 0.009;
  const Attempt before = attempt(candidate());
  ASSERT_TRUE(before.succeeded);
  ASSERT_GT(before.success_rate, 0.0);
  ASSERT_LT(before.success_rate, 1.0);
  const Pose X_WT = model::find_container(scenario_, scenario_.target)->X_WT;
  std::vector<bool> succeeds;
  for (const auto& end : before.ends) {
    const double off = (X_WT.inverse() * end[0]->p - before.planned.X_TP.p).head<2>().norm();
    succeeds.push_back(off <= cell_.limits.position);
  }
  // The box is seen where those worlds predicted it that will fail: they weigh more now.
  Pose seen = belief_->box(0)->X_WP, wrong = seen;
  wrong.p.x() += 0.02;
  std::vector<std::vector<std::optional<Pose>>> predicted;
  for (const bool one : succeeds) predicted.push_back({one ? wrong : seen, std::nullopt});
  const auto covariance = belief_->box(0)->covariance;
  belief_->expect(predicted);
  perception::Observation look;
  look.seen.push_back({"BOX027", seen, Matrix6::Zero(), {}, 0.0});
  belief_->see(look);
  belief_->weigh(0);
  belief_->arrives(0);  // once more, unseen, where each world has it
  EXPECT_EQ(belief_->box(0)->covariance, covariance);
  const Attempt after = attempt(candidate());
  double good = 0.0, all = 0.0;
  for (std::size_t w = 1; w < succeeds.size(); ++w) {
    good += succeeds[w] ? belief_->weights()[w] : 0.0;
    all += belief_->weights()[w];
  }
  EXPECT_NEAR(after.success_rate, good / all, 1e-12);
  EXPECT_LT(after.success_rate, before.success_rate);
}

TEST_F(RehearsalOfUnseenBoxes, WhatFailsInTheFirstSamplesIsNotTriedInTheRest) {
  scenario_.rehearsal.first_samples = 2;
  scenario_.rehearsal.least_rate = 1.0;
  believe(6, 3);
  cell_.limits.position = 0.0035;  // hardly any world
  const Attempt one = attempt(candidate());
  ASSERT_TRUE(one.succeeded) << one.text;
  EXPECT_EQ(one.samples, 2);
  EXPECT_LT(one.success_rate, 0.5);
}

}  // namespace
}  // namespace snug::session
