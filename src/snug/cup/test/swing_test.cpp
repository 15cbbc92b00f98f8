// find_swing: closed forms of one and two degrees of freedom.
#include "snug/cup/swing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace snug::cup {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

model::CupParams stiff_cup() {
  model::CupParams params;
  params.stiffness = {.lateral = 1e9, .axial = 1e9, .bend = 1e9, .torsion = 1e9};
  params.centre_from_lip = 0.0;
  return params;
}

double slowest(const model::CupParams& cup, const SpatialInertia& box_S, double gravity) {
  return find_swing(cup, box_S, gravity).slow;
}

TEST(FindSwing, IsThatOfEachSpringAlone) {
  const double mass = 2.0;
  const SpatialInertia box{mass, Vector3::Zero(), Vector3(0.01, 0.02, 0.03).asDiagonal()};
  model::CupParams cup = stiff_cup();
  cup.stiffness.axial = 800.0;
  EXPECT_NEAR(slowest(cup, box, 0.0), kTurn * std::sqrt(mass / 800.0), 1e-6);
  cup = stiff_cup();
  cup.stiffness.torsion = 3.0;
  EXPECT_NEAR(slowest(cup, box, 0.0), kTurn * std::sqrt(0.03 / 3.0), 1e-6);
  cup = stiff_cup();
  cup.stiffness.bend = 5.0;  // about the axis of the larger moment of inertia
  EXPECT_NEAR(slowest(cup, box, 0.0), kTurn * std::sqrt(0.02 / 5.0), 1e-6);
}

TEST(FindSwing, OfAPendulumIsThatOfItsWeightAndTheBendingTogether) {
  const double mass = 0.9, length = 0.12, below = 0.025, gravity = 9.81;
  model::CupParams cup = stiff_cup();
  cup.centre_from_lip = below;
  cup.stiffness.bend = 5.0;
  const SpatialInertia box{mass, {0.0, 0.0, length}, Vector3(0.004, 0.004, 0.001).asDiagonal()};
  const double arm = length + below;
  const double period = kTurn * std::sqrt((0.004 + mass * arm * arm) / (5.0 + mass * gravity * arm));
  EXPECT_NEAR(slowest(cup, box, gravity), period, 1e-6);
}

TEST(FindSwing, OfTwoCoupledMotionsIsTheRootOfTheirPolynomial) {
  const double mass = 1.0, arm = 0.1, moment = 0.005, lateral = 2500.0, bend = 5.0;
  model::CupParams cup = stiff_cup();
  cup.stiffness.lateral = lateral;
  cup.stiffness.bend = bend;
  const SpatialInertia box{mass, {0.0, 0.0, arm}, Vector3(moment, 1e-4, 1e-4).asDiagonal()};
  // det(K - w^2 M) = 0 with M = [m, m a; m a, I + m a^2].
  const double a = mass * moment, b = -(lateral * (moment + mass * arm * arm) + bend * mass), c = lateral * bend;
  const double square = (-b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
  EXPECT_NEAR(slowest(cup, box, 0.0), kTurn / std::sqrt(square), 1e-6);
  EXPECT_LE(find_swing(cup, box, 0.0).fast, find_swing(cup, box, 0.0).slow);
}

TEST(FindSwing, OfABoxGrowsWithWhatHangsBelowTheCup) {
  model::CupParams cup = stiff_cup();
  cup.stiffness = {.lateral = 2500.0, .axial = 6000.0, .bend = 5.0, .torsion = 1e6};
  const Vector3 size(0.17, 0.234, 0.094);
  const SpatialInertia box{0.946, {0.0, 0.0, -0.027}, Vector3(0.00456, 0.00239, 0.00653).asDiagonal()};
  const double flat = find_swing(cup, box, size, Vector3::UnitZ(), 9.81).slow;
  const double tall = find_swing(cup, box, size, Vector3::UnitY(), 9.81).slow;
  EXPECT_GT(tall, flat);
  // The heavy plate at the far end hangs lower.
  EXPECT_GT(flat, find_swing(cup, box, size, -Vector3::UnitZ(), 9.81).slow);
}

TEST(FindSwing, IsInfiniteWhereNothingHoldsTheBox) {
  const SpatialInertia box{1.0, Vector3::Zero(), Matrix3::Identity()};
  model::CupParams cup = stiff_cup();
  cup.stiffness.torsion = 0.0;
  EXPECT_TRUE(std::isinf(slowest(cup, box, 0.0)));
  EXPECT_TRUE(std::isinf(slowest(stiff_cup(), {0.0, Vector3::Zero(), Matrix3::Zero()}, 0.0)));
}

}  // namespace
}  // namespace snug::cup
