// Cylinders: closed forms, and distance and depth against a search over all directions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/geometry/convex_hull.hpp"

namespace snug::geometry {
namespace {

using test::at;
using test::collide_once;
using test::kAlongX;
using test::kTable;
using test::least_phi;

using std::numbers::pi;
constexpr double kCurvedRounding = 1e-14;  // sums and roots of numbers below 1 m
const Shape kCylinder = Cylinder{0.1, 0.03};

TEST(Cylinder, LyingOnAFaceTouchesAlongItsSide) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCylinder, at(0.02, 0, 0.079, kAlongX), 1e-3);
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR((m.n_AB_W - Vector3::UnitZ()).norm(), 0.0, kCurvedRounding);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(m.points[i].phi, -1e-3, kCurvedRounding);
    EXPECT_NEAR(std::abs(m.points[i].p_WA.x() - 0.02), 0.1, kCurvedRounding);
    EXPECT_NEAR(m.points[i].p_WA.y(), 0.0, kCurvedRounding);
    EXPECT_NEAR(m.points[i].p_WA.z(), 0.05, kCurvedRounding);
  }
}

TEST(Cylinder, StandingOnAFaceTouchesOnItsRim) {
  const Manifold m = collide_once(kTable, at(0, 0, 0), kCylinder, at(0.02, 0.01, 0.1499), 1e-3);
  ASSERT_EQ(m.count, kMaxManifoldPoints);
  for (std::size_t i = 0; i < kMaxManifoldPoints; ++i) {
    EXPECT_NEAR(m.points[i].phi, -1e-4, kCurvedRounding);
    EXPECT_NEAR((m.points[i].p_WB - Vector3(0.02, 0.01, 0.0499)).norm(), 0.03, kCurvedRounding);
  }
}

TEST(Cylinder, TiltedALittleTouchesDeepestWhereItsRimIsLowest) {
  Rng rng = Rng(3).split("cylinder tilt");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const double tilt = rng.uniform(1e-5, 0.1), heading = rng.uniform(0.0, 2.0 * pi);
    const Vector3 turn = tilt * Vector3(-std::sin(heading), std::cos(heading), 0.0);  // leans toward the heading
    const double lowest = 0.1 * std::cos(tilt) + 0.03 * std::sin(tilt);
    const Manifold m = collide_once(kTable, at(0, 0, 0), kCylinder, at(0, 0, 0.05 + lowest - 1e-4, turn), 1e-2);
    ASSERT_GT(m.count, 0);
    EXPECT_NEAR(least_phi(m), -1e-4, 1e-12);
    for (int k = 0; k < m.count; ++k) {
      const ManifoldPoint& point = m.points[static_cast<std::size_t>(k)];
      if (point.phi > -1e-4 + 1e-12) continue;
      const Vector3 expected = 0.03 * std::cos(tilt) * Vector3(std::cos(heading), std::sin(heading), 0.0) -
                               0.1 * std::sin(tilt) * Vector3(std::cos(heading), std::sin(heading), 0.0);
      EXPECT_NEAR((point.p_WA - expected).head<2>().norm(), 0.0, 1e-9);
    }
  }
}

TEST(Cylinder, LyingAcrossAnEdgeTouchesAtOnePoint) {
  // A bar along x over the edge of the table that runs along y, turned by 45 degrees about y.
  const Vector3 turn{0, pi / 4, 0};
  const Shape bar = Cylinder{0.5, 0.02};
  const Vector3 edge(0.2, 0.0, 0.05);
  const Vector3 n = Vector3(1, 0, 1).normalized();
  const Pose X_WB{exp_rotation({0, 3 * pi / 4, 0}), edge + (0.02 + 1e-3) * n};
  const Manifold m = collide_once(kTable, at(0, 0, 0), bar, X_WB, 2e-3);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].phi, 1e-3, kCurvedRounding);
  EXPECT_NEAR((m.points[0].p_WA - edge).norm(), 0.0, 1e-12);
}

TEST(Cylinder, PipesSideBySideTouchAtTwoPointsAndCrossedAtOne) {
  const Manifold beside = collide_once(kCylinder, at(0, 0, 0, kAlongX), kCylinder, at(0.05, 0, 0.0599, kAlongX), 1e-3);
  ASSERT_EQ(beside.count, 2);
  EXPECT_NEAR((beside.n_AB_W - Vector3::UnitZ()).norm(), 0.0, kCurvedRounding);
  EXPECT_NEAR(std::min(beside.points[0].p_WA.x(), beside.points[1].p_WA.x()), -0.05, kCurvedRounding);
  EXPECT_NEAR(std::max(beside.points[0].p_WA.x(), beside.points[1].p_WA.x()), 0.1, kCurvedRounding);
  const Manifold crossed =
      collide_once(kCylinder, at(0, 0, 0, kAlongX), kCylinder, at(0.01, 0.02, 0.0599, {pi / 2, 0, 0}), 1e-3);
  ASSERT_EQ(crossed.count, 1);
  EXPECT_NEAR(crossed.points[0].phi, -1e-4, kCurvedRounding);
  EXPECT_NEAR((crossed.points[0].p_WA - Vector3(0.01, 0.0, 0.03)).norm(), 0.0, 1e-12);
}

TEST(Cylinder, StackedOnEndsTouchesWhereBothEndsAre) {
  const Manifold m = collide_once(kCylinder, at(0, 0, 0), Cylinder{0.1, 0.05}, at(0.04, 0, 0.2), 1e-3);
  ASSERT_EQ(m.count, kMaxManifoldPoints);
  for (std::size_t i = 0; i < kMaxManifoldPoints; ++i) {
    EXPECT_NEAR(m.points[i].phi, 0.0, kCurvedRounding);
    EXPECT_LE((m.points[i].p_WA - Vector3(0, 0, 0.1)).norm(), 0.03 + kCurvedRounding);
    EXPECT_LE((m.points[i].p_WA - Vector3(0.04, 0, 0.1)).norm(), 0.05 + kCurvedRounding);
  }
}

TEST(Cylinder, SlidesOverASeamOnItsEnd) {
  // Two tiles that are flush; the cylinder stands on the first, a nanometre over the seam, pressed in by a micrometre.
  const Shape tile = Box{{0.1, 0.1, 0.05}};
  const Manifold m = collide_once(tile, at(0.1, 0, 0), kCylinder, at(-0.03 + 1e-9, 0, 0.15 - 1e-6), 2e-3);
  EXPECT_EQ(m.count, 0);
}

TEST(Cylinder, GivesTheSameBytesInEitherOrder) {
  const Pose X_WA = at(0.01, 0.02, 0.0, {0.3, 0.2, 0.1}), X_WB = at(0.05, 0.01, 0.07, {0.1, -0.4, 1.0});
  for (const Shape& other : {kTable, kCylinder, Shape(Capsule{0.1, 0.02})}) {
    const Manifold ab = collide_once(other, X_WA, kCylinder, X_WB, 0.1);
    const Manifold ba = collide_once(kCylinder, X_WB, other, X_WA, 0.1);
    ASSERT_EQ(ab.count, ba.count);
    ASSERT_GT(ab.count, 0);
    EXPECT_EQ(ab.n_AB_W, Vector3(-ba.n_AB_W));
    for (std::size_t i = 0; i < static_cast<std::size_t>(ab.count); ++i) {
      EXPECT_EQ(ab.points[i].p_WA, ba.points[i].p_WB);
      EXPECT_EQ(ab.points[i].phi, ba.points[i].phi);
    }
  }
}

TEST(Cylinder, WithAPoseThatIsNoNumberTouchesNothing) {
  const Pose nowhere{Matrix3::Identity(), Vector3(std::nan(""), 0, 0)};
  EXPECT_EQ(collide_once(kTable, at(0, 0, 0), kCylinder, nowhere, 1.0).count, 0);
  EXPECT_EQ(collide_once(kCylinder, nowhere, kCylinder, at(0, 0, 0), 1.0).count, 0);
}

TEST(Cylinder, BoundsAreThoseOfItsSupport) {
  Rng rng = Rng(5).split("cylinder bounds");
  for (int i = 0; i < 100; ++i) {
    const Pose X = at(0.3, -0.2, 0.1, {rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)});
    const Aabb box = bounds(Cylinder{0.2, 0.05}, X);
    Vector3 upper = Vector3::Constant(-1.0);
    for (int k = 0; k < 3600; ++k) {
      const double t = k * pi / 1800.0;
      for (const double z : {-0.2, 0.2}) upper = upper.cwiseMax(X * Vector3(0.05 * std::cos(t), 0.05 * std::sin(t), z));
    }
    EXPECT_LT((box.upper - upper).cwiseAbs().maxCoeff(), 1e-7);  // 0.05 (0.05 degrees)^2
  }
}

// --- against a search over all directions ---

/// Support written anew.
double support(const Shape& shape, const Pose& X, const Vector3& n) {
  const Vector3 m = X.R.transpose() * n;
  double reach = -1e300;
  if (const auto* box = std::get_if<Box>(&shape)) reach = m.cwiseAbs().dot(box->half);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    reach = capsule->half_length * std::abs(m.z()) + capsule->radius;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    reach = cylinder->half_length * std::abs(m.z()) + cylinder->radius * std::hypot(m.x(), m.y());
  }
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    for (const Vector3& v : hull->vertices) reach = std::max(reach, m.dot(v));
  }
  return reach + n.dot(X.p);
}

/// Largest separation along any direction: a lattice of directions, then shrinking random steps from the best few.
double largest_separation(const Shape& A, const Pose& X_WA, const Shape& B, const Pose& X_WB, Rng& rng) {
  const auto value = [&](const Vector3& n) { return -support(B, X_WB, -n) - support(A, X_WA, n); };
  std::vector<std::pair<double, Vector3>> starts;
  constexpr int kCount = 3000;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCount, r = std::sqrt(1.0 - z * z), t = 2.399963229728653 * i;
    const Vector3 n(r * std::cos(t), r * std::sin(t), z);
    starts.emplace_back(value(n), n);
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  double best = starts.front().first;
  for (std::size_t k = 0; k < 18; k += 3) {
    auto [now, n] = starts[k];
    for (double width = 0.05; width > 1e-9; width *= 0.8) {
      for (int i = 0; i < 12; ++i) {
        const Vector3 step(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const Vector3 next = (n + width * step).normalized();
        const double there = value(next);
        if (there <= now) continue;
        now = there;
        n = next;
      }
    }
    best = std::max(best, now);
  }
  return best;
}

Shape random_other(int kind, Rng& rng) {
  switch (kind) {
    case 0:
      return Box{{rng.uniform(0.02, 0.2), rng.uniform(0.02, 0.2), rng.uniform(0.02, 0.2)}};
    case 1:
      return Capsule{rng.uniform(0.0, 0.2), rng.uniform(0.01, 0.1)};
    case 2: {
      std::vector<Vector3> points;
      for (int i = 0; i < 20; ++i)
        points.emplace_back(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1));
      return *make_convex_hull(points);
    }
    default:
      return Cylinder{rng.uniform(0.02, 0.2), rng.uniform(0.02, 0.2)};
  }
}

/// Random, and with axes along the world's.
Vector3 random_turn(Rng& rng) {
  const Vector3 turn(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2));
  const double kind = rng.uniform(0.0, 1.0);
  if (kind < 0.15) return Vector3::Zero();
  if (kind < 0.3) return {0.5 * pi, 0.0, 0.0};
  if (kind < 0.4) return {0.0, 0.5 * pi, 0.0};
  return turn;
}

void compare_with_search(int kind) {
  Rng rng = Rng(12).split("cylinder search").split(std::to_string(kind));
  constexpr double kMargin = 0.05;
  const int count = kind == 3 ? 1000 : 300;
  int touching = 0;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const Shape other = random_other(kind, rng);
    const Shape cylinder = Cylinder{rng.uniform(0.02, 0.2), rng.uniform(0.02, 0.2)};
    const Pose X_WA = at(0, 0, 0, random_turn(rng));
    const Vector3 way = Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized();
    Pose X_WB{exp_rotation(random_turn(rng)), way};
    // Along the way to where they overlap by up to 2 cm, or are apart by up to 4 cm, along it.
    const double gap = -support(cylinder, X_WB, -way) - support(other, X_WA, way);
    X_WB.p += (rng.uniform(-0.02, 0.04) - gap) * way;
    const double expected = largest_separation(other, X_WA, cylinder, X_WB, rng);
    const Manifold m = collide_once(other, X_WA, cylinder, X_WB, kMargin);
    if (m.count == 0) {
      EXPECT_GT(expected, kMargin - 1e-6);
      continue;
    }
    ++touching;
    // What separates by the supports is no more than the largest separation, and the search finds no larger one; the
    // choice of a face costs 1 um + depth / 1000.
    const double separation = -support(cylinder, X_WB, -m.n_AB_W) - support(other, X_WA, m.n_AB_W);
    EXPECT_NEAR(least_phi(m), separation, 1.1e-6);
    EXPECT_GE(least_phi(m), expected - 1.1e-6 - 1e-3 * std::max(0.0, -expected));
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      const ManifoldPoint& point = m.points[k];
      EXPECT_NEAR(m.n_AB_W.dot(point.p_WB - point.p_WA), point.phi, 1e-12);
      EXPECT_NEAR((point.p_WB - point.p_WA).cross(m.n_AB_W).norm(), 0.0, 1e-12);
    }
  }
  EXPECT_GT(touching, count / 2);
}

TEST(CylinderSearch, AgreesWithBoxes) { compare_with_search(0); }
TEST(CylinderSearch, AgreesWithCapsules) { compare_with_search(1); }
TEST(CylinderSearch, AgreesWithHulls) { compare_with_search(2); }
TEST(CylinderSearch, AgreesWithCylinders) { compare_with_search(3); }

}  // namespace
}  // namespace snug::geometry
