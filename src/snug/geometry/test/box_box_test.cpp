// Closed forms and invariances of box-box contact.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "random_pair.hpp"
#include "scene.hpp"

namespace snug::geometry {
namespace {

using test::at;
using test::collide_once;
using test::features;
using test::kRounding;
using test::kTable;
using test::least_phi;

using std::numbers::pi;
// Sums of a few numbers below 1 m.

const Shape kBox = Box{{0.1, 0.08, 0.05}};

/// Two plates that lean on each other at an angle of `lean` from upright, their upper edges along y 0.2 um apart.
Manifold lean_plates(double lean, double gap, bool is_swapped) {
  const Shape plate = Box{{0.0005, 0.03, 0.044}};
  const auto placed = [&](double side) {  // the upper edge that meets the other plate is at x = -side gap / 2, z = 0
    const Matrix3 R = exp_rotation(Vector3(0.0, side * lean, 0.0));
    return Pose{R, Vector3(-0.5 * side * gap, 0.0, 0.0) - R * Vector3(side * 0.0005, 0.0, 0.044)};
  };
  const Pose left = placed(1.0);
  Pose right = placed(-1.0);
  right.p.y() += 0.01;
  return is_swapped ? collide_once(plate, right, plate, left, 1e-3) : collide_once(plate, left, plate, right, 1e-3);
}

TEST(BoxBox, ParallelEdgesPushHalfwayBetweenTheirFaces) {
  for (const bool is_swapped : {false, true}) {
    for (const double lean : {0.1, pi / 12.0, 0.5}) {
      SCOPED_TRACE(testing::Message() << lean << " rad");
      const Manifold m = lean_plates(lean, -2e-7, is_swapped);
      ASSERT_EQ(m.count, 2);
      EXPECT_LT((m.n_AB_W - Vector3(is_swapped ? -1.0 : 1.0, 0.0, 0.0)).norm(), 1e-9);
      for (const ManifoldPoint& point : std::span(m.points).first(2)) {
        EXPECT_NEAR(point.phi, -2e-7, 1e-12);
        EXPECT_NEAR(point.p_WA.z(), 0.0, 1e-9);
      }
      // The common part of the edges: y from -0.02 to 0.03.
      EXPECT_NEAR(std::abs(m.points[0].p_WA.y() - m.points[1].p_WA.y()), 0.05, 1e-9);
      EXPECT_NEAR(m.points[0].p_WA.y() + m.points[1].p_WA.y(), 0.01, 1e-9);
      EXPECT_NE(m.points[0].feature, m.points[1].feature);
    }
  }
}

TEST(BoxBox, ParallelEdgesThatOverlapDeeplyArePushedAlongAFace) {
  // Halfway between the faces the depth would be larger by 1/cos(lean) than the least one.
  const Manifold m = lean_plates(0.5, -1e-4, false);
  ASSERT_GT(m.count, 0);
  EXPECT_NEAR(least_phi(m), -1e-4 * std::cos(0.5), 1.1e-6);
}

TEST(BoxBox, FlatOnTableTouchesAtItsFourLowerCorners) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kBox, at(0.03, -0.02, 0.0999), 1e-3);
  ASSERT_EQ(m.count, 4);
  EXPECT_EQ(m.n_AB_W, Vector3::UnitZ());
  double x = 0.0;
  for (const ManifoldPoint& point : std::span(m.points).first(4)) {
    EXPECT_NEAR(point.phi, -1e-4, kRounding);
    EXPECT_NEAR(point.p_WA.z(), 0.05, kRounding);
    EXPECT_NEAR(std::abs(point.p_WA.x() - 0.03), 0.1, kRounding);
    EXPECT_NEAR(std::abs(point.p_WA.y() + 0.02), 0.08, kRounding);
    x += point.p_WA.x();
  }
  EXPECT_NEAR(x / 4.0, 0.03, kRounding);
}

TEST(BoxBox, TurnedOnItsLikeTouchesAtAnOctagonOfTheRightArea) {
  const Shape cube = Box{{0.1, 0.1, 0.1}};
  const Manifold m = collide_once(cube, at(0, 0, 0), cube, at(0, 0, 0.2, {0, 0, pi / 4}), 1e-3);
  ASSERT_EQ(m.count, 8);
  std::vector<Vector3> corners;
  for (const ManifoldPoint& point : m.points) corners.push_back(point.p_WA);
  std::sort(corners.begin(), corners.end(),
            [](const Vector3& a, const Vector3& b) { return std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x()); });
  double area = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vector3& p = corners[i];
    const Vector3& q = corners[(i + 1) % 8];
    area += 0.5 * (p.x() * q.y() - p.y() * q.x());
  }
  // Two squares of side a turned by 45 degrees share 2 (sqrt 2 - 1) a^2.
  EXPECT_NEAR(std::abs(area), 2.0 * (std::sqrt(2.0) - 1.0) * 0.04, 1e-15);
}

TEST(BoxBox, KnowTheAreaOverWhichTheirFacesOverlap) {
  const Box box{{0.1, 0.15, 0.05}};
  const auto area = [&](const Pose& X_WB) { return collide_once(box, Pose{}, box, X_WB, 1e-3).face_area; };
  EXPECT_NEAR(area(at(0.0, 0.0, 0.0995)), 0.2 * 0.3, 1e-12);
  EXPECT_NEAR(area(at(0.196, 0.02, 0.0995)), 0.004 * 0.28, 1e-12);
  EXPECT_NEAR(area(at(0.196, 0.298, 0.0995)), 0.004 * 0.002, 1e-12);
  // A face that leans counts whole, though only its edge is within the margin.
  EXPECT_NEAR(area(at(0.0, 0.0, 0.103, Vector3(0.0, 0.03, 0.0))), 0.2 * 0.3, 2e-3);
  // Crossed edges have none.
  const Pose X_WB = at(0.0, 0.0, 0.205, Vector3(0.25 * std::numbers::pi, 0.0, 0.0));
  const Box cube{{0.1, 0.1, 0.1}};
  const Pose X_WA = {exp_rotation(Vector3(0.0, 0.25 * std::numbers::pi, 0.0)), Vector3(0.0, 0.0, -0.07)};
  const Manifold crossed = collide_once(cube, X_WA, cube, X_WB, 0.02);
  ASSERT_EQ(crossed.count, 1);
  EXPECT_EQ(crossed.face_area, 0.0);
}

TEST(BoxBox, CrossedEdgesTouchAtOnePoint) {
  const Shape cube = Box{{0.1, 0.1, 0.1}};
  // Upper edge of A along x, lower edge of B along y, both boxes on edge.
  const double diagonal = 0.1 * std::numbers::sqrt2;
  const Manifold m =
      collide_once(cube, at(0, 0, 0, {pi / 4, 0, 0}), cube, at(0.02, 0.03, 2 * diagonal - 1e-3, {0, pi / 4, 0}), 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR((m.n_AB_W - Vector3::UnitZ()).norm(), 0.0, 1e-15);
  EXPECT_NEAR(m.points[0].phi, -1e-3, kRounding);
  EXPECT_NEAR(m.points[0].p_WA.z(), diagonal, kRounding);
  EXPECT_NEAR(m.points[0].p_WA.x(), 0.02, kRounding);
  EXPECT_NEAR(m.points[0].p_WA.y(), 0.0, 1e-15);
}

TEST(BoxBox, PassingCornerToCornerHasTheEuclideanDistanceAndDirection) {
  const Shape cube = Box{{0.1, 0.1, 0.1}};
  const Vector3 gap(3e-4, 4e-4, 1.2e-3);  // length 1.3e-3
  const Manifold m = collide_once(cube, at(0, 0, 0), cube, {Matrix3::Identity(), Vector3(0.2, 0.2, 0.2) + gap}, 2e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 1.3e-3, kRounding);
  // The gap is rounded at 0.2 m: 3e-17 in 1e-3.
  EXPECT_NEAR((m.n_AB_W - gap / 1.3e-3).norm(), 0.0, 1e-12);
  EXPECT_EQ(collide_once(cube, at(0, 0, 0), cube, {Matrix3::Identity(), Vector3(0.2, 0.2, 0.2) + gap}, 1.29e-3).count,
            0);
}

TEST(BoxBox, ParallelEdgesApartTouchInTheMiddleOfTheirOverlap) {
  const Shape cube = Box{{0.1, 0.1, 0.1}};
  const Manifold m = collide_once(cube, at(0, 0, 0), cube, at(0.2003, 0.2004, 0.05), 1e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 5e-4, kRounding);
  EXPECT_NEAR(m.points[0].p_WA.z(), 0.025, kRounding);
}

TEST(BoxBox, EmptyBeyondTheMarginAndFullWithin) {
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kBox, at(0, 0, 0.1011), 1e-3).count, 0);
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kBox, at(0, 0, 0.1009), 1e-3).count, 4);
}

TEST(BoxBox, CoincidentEqualBoxesPartAlongTheShortestEdge) {
  const Shape box = Box{{0.3, 0.2, 0.1}};
  const Manifold m = collide_once(box, at(0, 0, 0), box, at(0, 0, 0), 0.0);
  ASSERT_EQ(m.count, 4);
  EXPECT_NEAR(least_phi(m), -0.2, kRounding);
  EXPECT_NEAR(std::abs(m.n_AB_W.z()), 1.0, kRounding);
}

TEST(BoxBox, ContainedBoxPartsThroughTheNearestFace) {
  const Shape outer = Box{{0.5, 0.5, 0.5}};
  const Shape inner = Box{{0.05, 0.05, 0.05}};
  const Manifold m = collide_once(outer, at(0, 0, 0), inner, at(0.1, 0.3, -0.2), 0.0);
  ASSERT_EQ(m.count, 4);
  EXPECT_NEAR(least_phi(m), -(0.5 - 0.3 + 0.05), kRounding);
  EXPECT_NEAR((m.n_AB_W - Vector3::UnitY()).norm(), 0.0, kRounding);
}

TEST(BoxBox, LeaningOverARimByATinyAngleKeepsItsPolygonAndTheDepthOfTheCrossingEdges) {
  // The turn is about a diagonal, so the lowest corner hangs outside and edges cross over the rim.
  const Pose X_WB = at(0.15, 0.15, 0.1, 2e-3 * Vector3(-1, 1, 0).normalized());
  const Manifold m = collide_once(kTable, at(0, 0, 0), Box{{0.1, 0.1, 0.05}}, X_WB, 1e-3);
  EXPECT_GE(m.count, 3);
  EXPECT_GT(m.n_AB_W.z(), 0.99999);
}

TEST(BoxBox, FaceLeaningOnARimKeepsBothEndsOfTheRimWhileItRocks) {
  const Shape wall = Box{{0.005, 0.2, 0.1}};
  const double rock = 0.004;
  for (const double gap : {-1e-4, 5e-4}) {  // overlapping at one end, and apart
    const Matrix3 R = exp_rotation({0, pi / 6, 0}) * exp_rotation({rock, 0, 0});
    const Pose X_WB{R, Vector3(0.005, 0, 0.1) + R * Vector3(0, 0, 0.05 + gap)};
    const Manifold m = collide_once(wall, at(0, 0, 0), kBox, X_WB, 2e-3);
    ASSERT_EQ(m.count, 2) << gap;
    const auto [low, high] = std::minmax(m.points[0].phi, m.points[1].phi);
    // The rim crosses 2 x 80 mm of the face, which turns away from it; second order in the angle is left out.
    EXPECT_NEAR(low, gap - 0.08 * rock, 0.08 * rock * rock) << gap;
    EXPECT_NEAR(high, gap + 0.08 * rock, 2.0 * 0.08 * rock * rock) << gap;
  }
}

TEST(BoxBox, AnswersTheSameInAnyFrame) {
  Rng rng(11);
  const test::PairMaker maker(1, 50);
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    const auto pair = maker.make(test::Family::General, rng);
    const Manifold m = collide_once(pair.A, pair.X_WA, pair.B, pair.X_WB, pair.margin);
    const Pose X_NW{test::random_rotation(rng), Vector3(rng.normal(), rng.normal(), rng.normal()).normalized() * 10.0};
    const Manifold r = collide_once(pair.A, X_NW * pair.X_WA, pair.B, X_NW * pair.X_WB, pair.margin);
    // Places at 10 m are rounded to 2e-15 m; a gap at the margin or a tie at that distance may turn.
    if (m.count != r.count) {
      EXPECT_TRUE(std::abs(least_phi(m.count > 0 ? m : r)) < 1e-13 ||
                  std::abs(least_phi(m.count > 0 ? m : r) - pair.margin) < 1e-13);
      continue;
    }
    if (m.count == 0) continue;
    EXPECT_NEAR(least_phi(m), least_phi(r), 1e-13);
    // A direction from points that are d apart is known to 1e-14 / d.
    const double tolerance = 1e-9 + 1e-13 / std::max(std::abs(least_phi(m)), 1e-6);
    EXPECT_NEAR((X_NW.R * m.n_AB_W - r.n_AB_W).norm(), 0.0, tolerance);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      EXPECT_NEAR((X_NW * m.points[k].p_WA - r.points[k].p_WA).norm(), 0.0, 1e-9);
      EXPECT_EQ(m.points[k].feature, r.points[k].feature);
    }
  }
}

TEST(BoxBox, NamesPersistUnderSmallMotionOfAFlatContact) {
  Rng rng(3);
  for (int scene = 0; scene < 200; ++scene) {
    SCOPED_TRACE(scene);
    const double yaw = rng.uniform(0.05, 1.5);
    const Pose X_WB = at(rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.1, {0, 0, yaw});
    PairCache cache;
    Manifold first;
    collide(kTable, at(0, 0, 0), kBox, X_WB, 1e-3, cache, first);
    for (int step = 0; step < 50; ++step) {
      Pose moved = X_WB;
      moved.p += 1e-5 * Vector3(rng.normal(), rng.normal(), rng.normal());
      moved.R = exp_rotation(1e-5 * Vector3(rng.normal(), rng.normal(), rng.normal())) * moved.R;
      Manifold m;
      collide(kTable, at(0, 0, 0), kBox, moved, 1e-3, cache, m);
      ASSERT_EQ(features(m), features(first));
    }
  }
}

TEST(BoxBox, NamesPersistWhenEqualBoxesAreStackedFlushAndShakenByMicrometres) {
  Rng rng(5);
  PairCache cache;
  Manifold first;
  collide(kBox, at(0, 0, 0), kBox, at(0, 0, 0.1), 1e-3, cache, first);
  ASSERT_EQ(first.count, 4);
  const std::uint32_t axis = cache.features;
  for (int step = 0; step < 5000; ++step) {
    Pose moved = at(0, 0, 0.1);
    moved.p += 1e-6 * Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    moved.R = exp_rotation(1e-6 * Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)));
    Manifold m;
    collide(kBox, at(0, 0, 0), kBox, moved, 1e-3, cache, m);
    EXPECT_EQ(cache.features, axis);
    // A corner cut off by less than the merge distance may add a point; the four corners keep their names.
    for (const std::uint32_t name : features(first)) EXPECT_TRUE(features(m).contains(name));
  }
}

TEST(BoxBox, KeepsItsFaceWhileTwoFacesTie) {
  // Two equal cubes meeting corner-on at equal depth along x and y: the first choice stays.
  const Shape cube = Box{{0.1, 0.1, 0.1}};
  Rng rng(9);
  PairCache cache;
  Manifold m;
  collide(cube, at(0, 0, 0), cube, at(0.19, 0.19, 0), 0.0, cache, m);
  const Vector3 n = m.n_AB_W;
  for (int step = 0; step < 1000; ++step) {
    collide(cube, at(0, 0, 0), cube, at(0.19 + 1e-7 * rng.normal(), 0.19 + 1e-7 * rng.normal(), 0), 0.0, cache, m);
    ASSERT_EQ(m.n_AB_W, n);
  }
}

TEST(BoxBox, RemembersWhatSeparatesButAnswersTheSameWithoutMemory) {
  PairCache cache;
  Manifold m;
  collide(kTable, at(0, 0, 0), kBox, at(0, 0, 0.5), 1e-3, cache, m);
  EXPECT_NE(cache.features, 0U);
  collide(kTable, at(0, 0, 0), kBox, at(0, 0, 0.0999), 1e-3, cache, m);
  EXPECT_EQ(m.count, 4);
  const PairCache nonsense{0x7ABCDEF1U};
  PairCache any = nonsense;
  collide(kTable, at(0, 0, 0), kBox, at(0, 0, 0.0999), 1e-3, any, m);
  EXPECT_EQ(m.count, 4);
}

TEST(BoxBox, HasNoContactWhenAPoseIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kBox, at(0, 0, nan), 1e-3).count, 0);
  EXPECT_EQ(collide_once(kTable, at(nan, 0, 0), kBox, at(0, 0, 0), 1e-3).count, 0);
  Pose turned;
  turned.R.setConstant(nan);
  EXPECT_EQ(collide_once(kTable, turned, kBox, at(0, 0, 0), 1e-3).count, 0);
}

TEST(BoxBox, FindsNothingVeryFarAway) {
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kBox, at(1e12, -1e12, 1e12), 1e-3).count, 0);
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kBox, at(1e200, 0, 0), 1e-3).count, 0);
}

}  // namespace
}  // namespace snug::geometry
