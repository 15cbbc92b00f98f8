// Closed forms of contact with capsules and balls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"
#include "snug/geometry/convex_hull.hpp"

namespace snug::geometry {
namespace {

using test::at;
using test::collide_once;
using test::kAlongX;
using test::kRounding;
using test::kTable;
using test::least_phi;

using std::numbers::pi;
const Shape kCapsule = Capsule{0.1, 0.02};

TEST(BoxCapsule, LyingOnAFaceTouchesAtTwoPoints) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0.02, 0, 0.069, kAlongX), 1e-3);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR((m.n_AB_W - Vector3::UnitZ()).norm(), 0.0, kRounding);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(m.points[i].phi, -1e-3, kRounding);
    EXPECT_NEAR(std::abs(m.points[i].p_WA.x() - 0.02), 0.1, kRounding);
    EXPECT_NEAR(m.points[i].p_WA.z(), 0.05, kRounding);
    EXPECT_NEAR(m.points[i].p_WB.z(), 0.049, kRounding);
  }
}

TEST(BoxCapsule, HangingOverTheRimTouchesAtItsEndAndAtTheRim) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0.17, 0, 0.07, kAlongX), 1e-3);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(std::max(m.points[0].p_WA.x(), m.points[1].p_WA.x()), 0.2, kRounding);
  EXPECT_NEAR(std::min(m.points[0].p_WA.x(), m.points[1].p_WA.x()), 0.07, kRounding);
}

TEST(BoxCapsule, TiltedTouchesFaceWithItsLowerEndAndTheOtherEndStaysApart) {
  const double tilt = 5e-3;
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0, 0, 0.07, {0, pi / 2 + tilt, 0}), 2e-3);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(least_phi(m), -0.1 * std::sin(tilt), kRounding);
  // The upper end meets the normal through its round wall, r / cos(tilt) from the axis.
  const double upper = std::max(m.points[0].phi, m.points[1].phi);
  EXPECT_NEAR(upper, 0.1 * std::sin(tilt) + 0.02 - 0.02 / std::cos(tilt), kRounding);
}

TEST(BoxCapsule, StandingTouchesAtOnePointBelowItsEnd) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0.05, 0.06, 0.1695), 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, -5e-4, kRounding);
  EXPECT_NEAR((m.points[0].p_WA - Vector3(0.05, 0.06, 0.05)).norm(), 0.0, kRounding);
}

TEST(BoxCapsule, AgainstAnEdgeTouchesAtOnePointAlongTheShortestLine) {
  // Axis parallel to y, outside the upper edge at 45 degrees.
  const double off = 0.02 / std::numbers::sqrt2;
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0.2 + off, 0, 0.05 + off, {pi / 2, 0, 0}), 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 0.0, kRounding);
  EXPECT_NEAR((m.n_AB_W - Vector3(1, 0, 1).normalized()).norm(), 0.0, 1e-14);
}

TEST(BoxCapsule, EndAgainstACornerHasTheEuclideanDistance) {
  const Vector3 corner(0.2, 0.2, 0.05);
  const Vector3 out = Vector3(1, 1, 1).normalized();
  const Manifold m =
      collide_once(kTable, at(0, 0, 0), Capsule{0.0, 0.02}, {Matrix3::Identity(), corner + (0.02 + 3e-4) * out}, 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 3e-4, kRounding);
  EXPECT_NEAR((m.n_AB_W - out).norm(), 0.0, 1e-14);
  EXPECT_NEAR((m.points[0].p_WA - corner).norm(), 0.0, kRounding);
}

TEST(BoxCapsule, WithItsAxisInsideTheBoxLeavesThroughTheNearestFace) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCapsule, at(0, 0, 0.03, kAlongX), 0.0);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(least_phi(m), -(0.02 + 0.02), kRounding);
  EXPECT_NEAR(m.n_AB_W.z(), 1.0, kRounding);
}

TEST(BoxCapsule, NormalPointsFromTheFirstArgument) {
  const Manifold m = collide_once(kCapsule, at(0.02, 0, 0.069, kAlongX), kTable, at(0, 0, 0), 1e-3);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR((m.n_AB_W + Vector3::UnitZ()).norm(), 0.0, kRounding);
  EXPECT_NEAR(m.points[0].p_WA.z(), 0.049, kRounding);
}

TEST(HullCapsule, AgreesWithTheBoxThatTheHullIs) {
  std::vector<Vector3> corners;
  for (int v = 0; v < 8; ++v) {
    corners.emplace_back((v & 1) != 0 ? 0.2 : -0.2, (v & 2) != 0 ? 0.2 : -0.2, (v & 4) != 0 ? 0.05 : -0.05);
  }
  const Shape hull = make_convex_hull(corners).value();
  const Pose X_WB = at(0.1, 0.02, 0.0699, {0.1, pi / 2 + 1e-3, 0.2});
  const Manifold a = collide_once(kTable, at(0, 0, 0), kCapsule, X_WB, 1e-3);
  const Manifold b = collide_once(hull, at(0, 0, 0), kCapsule, X_WB, 1e-3);
  ASSERT_GT(a.count, 0);
  EXPECT_EQ(a.count, b.count);
  EXPECT_NEAR(least_phi(a), least_phi(b), kRounding);
}

TEST(CapsuleCapsule, CrossedTouchWhereTheAxesAreNearest) {
  const Manifold m =
      collide_once(kCapsule, at(0, 0, 0, kAlongX), kCapsule, at(0.03, 0.02, 0.0401, {pi / 2, 0, 0}), 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 1e-4, kRounding);
  EXPECT_NEAR((m.n_AB_W - Vector3::UnitZ()).norm(), 0.0, 1e-13);
  EXPECT_NEAR(m.points[0].p_WA.x(), 0.03, kRounding);
}

TEST(CapsuleCapsule, WithCrossingAxesStillHasADirection) {
  const Manifold m = collide_once(kCapsule, at(0, 0, 0, kAlongX), kCapsule, at(0, 0, 0, {pi / 2, 0, 0}), 0.0);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, -0.04, kRounding);
  EXPECT_NEAR(std::abs(m.n_AB_W.z()), 1.0, 1e-14);
}

TEST(CapsuleCapsule, CoincidentIsFinite) {
  const Manifold m = collide_once(kCapsule, at(0, 0, 0), kCapsule, at(0, 0, 0), 0.0);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, -0.04, kRounding);
  EXPECT_NEAR(m.n_AB_W.norm(), 1.0, kRounding);
}

}  // namespace
}  // namespace snug::geometry
