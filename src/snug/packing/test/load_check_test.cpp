// Finished loads: what is asked of every box, by closed forms.
#include "snug/packing/load_check.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/packing/test/scene.hpp"

namespace snug::packing {
namespace {

using test::make_box;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Cubes of 100 mm and 1 kg with their middles there, in a container of 400x400x300.
ContainerState cubes(const std::vector<Vector3>& middles) {
  ContainerState state;
  state.inner_size = Vector3(0.4, 0.4, 0.3);
  for (const Vector3& p : middles) {
    state.boxes.push_back(
        {make_box("B" + std::to_string(state.boxes.size()), Vector3::Constant(0.1)), {Matrix3::Identity(), p}});
  }
  return state;
}

TEST(FinishedLoad, OfBoxesThatStandOnFloorAndOnEachOtherHasNoFaults) {
  EXPECT_TRUE(check_finished_load(cubes({{0, 0, 0.05}, {0.1, 0, 0.05}, {0.05, 0, 0.15}}), {}).empty());
  EXPECT_TRUE(check_finished_load(cubes({}), {}).empty());
}

TEST(FinishedLoad, NamesTheBoxThatLeansWithItsAngle) {
  for (const double degrees : {5.9, 6.2, 27.6, 44.0}) {
    ContainerState state = cubes({{0, 0, 0.05}, {0.12, 0, 0.06}});
    state.boxes[1].X_TP.R = exp_rotation(Vector3(0.0, degrees * kDegree, 0.0));
    LoadLimits limits;
    limits.tilt = 6.0 * kDegree;
    limits.outside = 0.05;
    limits.min_support = 0.0;
    const auto findings = check_finished_load(state, limits);
    ASSERT_EQ(findings.size(), degrees > 6.0 ? 1U : 0U) << degrees;
    if (findings.empty()) continue;
    EXPECT_EQ(findings[0].item, "B1");
    EXPECT_EQ(findings[0].fault, LoadFault::Leans);
    EXPECT_NEAR(findings[0].value, degrees * kDegree, 1e-9);
  }
}

TEST(FinishedLoad, FailsABoxOnlyByMoreThanItsPoseMayBeOff) {
  ContainerState state = cubes({{0.158, 0, 0.05}, {-0.158, 0, 0.05}});  // both 8 mm beyond a wall
  const std::vector<PoseDoubt> doubts = {{0.0, 0.0}, {0.0035, 0.0}};
  const auto findings = check_finished_load(state, {}, doubts);  // 5 mm are allowed
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].item, "B0");
  state = cubes({{0, 0, 0.07}});  // in the air, and perhaps leaning: the second fault is found behind the first
  state.boxes[0].X_TP.R = exp_rotation(Vector3(0.0, 0.12, 0.0));
  EXPECT_EQ(check_finished_load(state, {}).at(0).fault, LoadFault::Leans);
  EXPECT_EQ(check_finished_load(state, {}, std::vector<PoseDoubt>{{0.0, 0.05}}).at(0).fault, LoadFault::Unsupported);
}

TEST(FinishedLoad, ABoxThatIsTurnedAboutTheVerticalDoesNotLean) {
  ContainerState state = cubes({{0, 0, 0.05}});
  state.boxes[0].X_TP.R = exp_rotation(Vector3(0.0, 0.0, 0.4));
  EXPECT_TRUE(check_finished_load(state, {}).empty());
}

TEST(FinishedLoad, AHeavyStackGivesWayOnTheFloorButDoesNotSinkThroughIt) {
  // Two boxes of 6 kg on a face of 1.5e4 N/m: 7.8 mm.
  EXPECT_TRUE(check_finished_load(cubes({{0, 0, 0.0422}}), {}).empty());
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.0395}}), {}).at(0).fault, LoadFault::Outside);
}

TEST(FinishedLoad, ABoxMaySinkAsFarAsSoftFacesGiveUnderWhatItCarries) {
  // Three of 6 kg on one another, 1 mm for 15 N: 3.9 mm under one, 11.8 mm under three.
  ContainerState tower = cubes({{0, 0, 0.0382}, {0, 0, 0.1304}, {0, 0, 0.2265}});
  for (PlacedBox& box : tower.boxes) box.item.mass = 6.0;
  LoadLimits limits;
  EXPECT_EQ(check_finished_load(tower, limits).size(), 1U);
  limits.on_floor = limits.on_box = {1.0 / 1.5e4, 0.01};
  EXPECT_TRUE(check_finished_load(tower, limits).empty());
  // The edge of a face goes twice as deep before the far edge lifts: 23.5 mm and 10 mm of slack.
  const auto sunk_to = [&](double depth) {
    ContainerState sunk = tower;
    for (PlacedBox& box : sunk.boxes) box.X_TP.p.z() += 0.0118 - depth;
    return check_finished_load(sunk, limits);
  };
  EXPECT_TRUE(sunk_to(0.0334).empty());
  const auto too_deep = sunk_to(0.0337);
  ASSERT_EQ(too_deep.size(), 1U);
  EXPECT_EQ(too_deep[0].item, "B0");
  EXPECT_EQ(too_deep[0].fault, LoadFault::Outside);
  EXPECT_NEAR(too_deep[0].limit, 0.010 + 2.0 * 18.0 * 9.81 / 1.5e4, 1e-9);
  // A box alone weighs less and may sink less, and none may hang in the air by more than before.
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.0385}}), limits).at(0).fault, LoadFault::Outside);
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.0605}}), limits).at(0).fault, LoadFault::Unsupported);
}

TEST(FinishedLoad, ABoxThatIsPressedIntoTheOneBelowIsSupportedByIt) {
  ContainerState pair = cubes({{0, 0, 0.05}, {0, 0, 0.137}});  // 13 mm into it
  pair.boxes[1].item.mass = 12.0;
  LoadLimits limits;
  EXPECT_EQ(check_finished_load(pair, limits).at(0).fault, LoadFault::Unsupported);
  limits.on_box = {1.0 / 1.5e4, 0.01};
  EXPECT_TRUE(check_finished_load(pair, limits).empty());
  limits.on_box.full_area = 0.02;  // half of the face that is fully stiff: twice as far
  pair.boxes[1].X_TP.p.z() = 0.112;
  EXPECT_TRUE(check_finished_load(pair, limits).empty());
}

TEST(FinishedLoad, FindsWhatSticksOutHangsInTheAirOrCarriesTooMuch) {
  EXPECT_EQ(check_finished_load(cubes({{0.16, 0, 0.05}}), {}).at(0).fault, LoadFault::Outside);
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.05}, {0, 0, 0.15}, {0, 0, 0.26}}), {}).at(0).fault, LoadFault::Outside);
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.05}, {0.075, 0, 0.15}}), {}).at(0).fault, LoadFault::Unsupported);
  EXPECT_EQ(check_finished_load(cubes({{0, 0, 0.07}}), {}).at(0).fault, LoadFault::Unsupported)
      << "20 mm over the floor";
  ContainerState tower = cubes({{0, 0, 0.05}, {0, 0, 0.15}, {0, 0, 0.25}});
  tower.boxes[0].item.max_load = 1.5;
  const auto findings = check_finished_load(tower, {});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, LoadFault::Overloaded);
  EXPECT_DOUBLE_EQ(findings[0].value, 2.0);
}

TEST(FinishedLoad, MassesGoDownThroughTheAreasThatBoxesShare) {
  // One cube stands on two with 70 and 30 mm of its edge; what the floor carries is the mass of all.
  const std::vector<double> loads = loads_on(cubes({{0, 0, 0.05}, {0.1, 0, 0.05}, {0.03, 0, 0.15}}), 0.005);
  EXPECT_NEAR(loads[0], 0.7, 1e-12);
  EXPECT_NEAR(loads[1], 0.3, 1e-12);
  EXPECT_EQ(loads[2], 0.0);
}

TEST(LevelAcceleration, IsWhatTipsOrSlidesTheBoxThatNothingHolds) {
  // A free cube tips at g, its lever as long as its height, and slides at mu g.
  ContainerState free = cubes({{0, 0, 0.05}});
  free.has_walls = false;
  EXPECT_NEAR(least_level_acceleration(free, 0.3, 0.005), 0.3 * 9.81, 1e-9);
  EXPECT_NEAR(least_level_acceleration(free, 2.0, 0.005), 9.81, 1e-9);
  // 100 mm wide, 300 high: it tips at a third of g.
  free.boxes[0].item.size = Vector3(0.1, 0.1, 0.3);
  free.boxes[0].X_TP.p.z() = 0.15;
  EXPECT_NEAR(least_level_acceleration(free, 0.5, 0.005), 9.81 / 3.0, 1e-9);
  EXPECT_TRUE(std::isinf(least_level_acceleration(cubes({}), 0.3, 0.005)));
}

TEST(LevelAcceleration, IsNotLimitedByBoxesThatWallsAndNeighboursHold) {
  std::vector<Vector3> full;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) full.emplace_back(-0.15 + 0.1 * x, -0.15 + 0.1 * y, 0.05);
  }
  EXPECT_TRUE(std::isinf(least_level_acceleration(cubes(full), 0.3, 0.005)));
  ContainerState pallet = cubes(full);
  pallet.has_walls = false;
  EXPECT_NEAR(least_level_acceleration(pallet, 0.3, 0.005), 0.3 * 9.81, 1e-9) << "boxes at the edge are free";
}

}  // namespace
}  // namespace snug::packing
