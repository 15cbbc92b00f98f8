// make_convex_hull: closed, convex, merged; and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "random_pair.hpp"
#include "scene.hpp"
#include "snug/geometry/convex_hull.hpp"

namespace snug::geometry {
namespace {

using test::at;
using test::collide_once;

std::vector<Vector3> box_corners(const Vector3& half) {
  std::vector<Vector3> corners;
  for (int v = 0; v < 8; ++v) {
    corners.emplace_back((v & 1) != 0 ? half.x() : -half.x(), (v & 2) != 0 ? half.y() : -half.y(),
                         (v & 4) != 0 ? half.z() : -half.z());
  }
  return corners;
}

TEST(ConvexHull, OfABoxHasSixFacesWhateverLiesInsideOrOnIt) {
  Rng rng(1);
  std::vector<Vector3> points = box_corners({0.3, 0.2, 0.1});
  for (int i = 0; i < 300; ++i) {
    Vector3 p(rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1));
    if (i % 3 == 0) p.z() = 0.1;   // on a face
    if (i % 9 == 0) p.y() = -0.2;  // on an edge
    points.push_back(p);
  }
  const auto hull = make_convex_hull(points);
  ASSERT_TRUE(hull.has_value());
  EXPECT_EQ(hull->vertices.size(), 8U);
  EXPECT_EQ(hull->faces.size(), 6U);
  EXPECT_EQ(hull->edges.size(), 12U);
}

TEST(ConvexHull, IsClosedAndConvexAndContainsItsPoints) {
  Rng rng(2);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    std::vector<Vector3> points;
    const int count = 4 + rng.index(25);
    for (int k = 0; k < count; ++k) points.push_back(0.1 * Vector3(rng.normal(), rng.normal(), rng.normal()));
    const auto hull = make_convex_hull(points);
    ASSERT_TRUE(hull.has_value());
    EXPECT_EQ(hull->vertices.size() + hull->faces.size(), hull->edges.size() + 2);  // Euler
    for (std::size_t f = 0; f < hull->faces.size(); ++f) {
      EXPECT_NEAR(hull->normals[f].norm(), 1.0, 1e-14);
      const Vector3& o = hull->vertices[static_cast<std::size_t>(hull->faces[f][0])];
      // Points up to 1e-7 of the size (below 1 m) outside count as on the hull; merged faces bend as much again.
      for (const Vector3& p : points) EXPECT_LT(hull->normals[f].dot(p - o), 4e-7);
    }
    for (const auto& e : hull->edges) EXPECT_NE(e[2], e[3]);
  }
}

TEST(ConvexHull, OfAPrismMergesTheTrianglesOfItsBases) {
  std::vector<Vector3> points;
  for (int i = 0; i < 32; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 32;
    points.emplace_back(0.035 * std::cos(angle), 0.035 * std::sin(angle), 0.0);
    points.emplace_back(0.035 * std::cos(angle), 0.035 * std::sin(angle), 0.05);
  }
  const auto hull = make_convex_hull(points);
  ASSERT_TRUE(hull.has_value());
  EXPECT_EQ(hull->vertices.size(), 64U);
  EXPECT_EQ(hull->faces.size(), 34U);
  const Manifold m = collide_once(Box{{0.2, 0.2, 0.05}}, at(0, 0, 0), *hull, at(0, 0, 0.0499), 1e-3);
  EXPECT_EQ(m.count, kMaxManifoldPoints);
  EXPECT_NEAR(test::least_phi(m), -1e-4, 1e-15);
  // Eight of 32 corners on the circle keep nearly all of the area: at least the square's 2 r^2.
  double area = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vector3& p = m.points[i].p_WA;
    const Vector3& q = m.points[(i + 1) % 8].p_WA;
    area += 0.5 * (p.x() * q.y() - p.y() * q.x());
  }
  EXPECT_GT(std::abs(area), 2.5 * 0.035 * 0.035);
}

TEST(ConvexHull, RefusesWhatIsNoBody) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vector3> three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(make_convex_hull(three).error(), NoHull::TooFewPoints);
  EXPECT_EQ(make_convex_hull(std::vector<Vector3>(9, Vector3::Ones())).error(), NoHull::TooFewPoints);
  EXPECT_EQ(make_convex_hull({}).error(), NoHull::TooFewPoints);
  const std::vector<Vector3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_EQ(make_convex_hull(flat).error(), NoHull::Flat);
  const std::vector<Vector3> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_EQ(make_convex_hull(line).error(), NoHull::Flat);
  const std::vector<Vector3> broken = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, nan}};
  EXPECT_EQ(make_convex_hull(broken).error(), NoHull::NotFinite);
  Rng rng(4);
  std::vector<Vector3> ball;
  for (int i = 0; i < 200; ++i) ball.push_back(Vector3(rng.normal(), rng.normal(), rng.normal()).normalized());
  EXPECT_EQ(make_convex_hull(ball).error(), NoHull::TooManyVertices);
}

TEST(ConvexHull, EndsWhereRoundingTearsTheSurface) {
  // A bar with rounded corners in single precision, as mesh files have it: a point sees triangles that are not next to
  // each other, and each point after it would add a quarter to the triangles.
  const double length = 80.0739, width = 23.177, height = 7.40016, radius = 0.338366;
  constexpr int kSteps = 14;
  std::vector<Vector3> bar;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const double a = 0.5 * std::numbers::pi * i / kSteps, b = 0.5 * std::numbers::pi * j / kSteps;
        const Vector3 at(length + radius * std::sin(a) * std::cos(b), width + radius * std::sin(a) * std::sin(b),
                         height + radius * std::cos(a));
        bar.push_back(0.001 * at.cwiseProduct(sign).cast<float>().cast<double>());
      }
    }
  }
  EXPECT_EQ(make_convex_hull(bar).error(), NoHull::TooManyVertices);
}

TEST(HullHull, AgreesWithTheBoxesThatTheHullsAre) {
  Rng rng(8);
  const test::PairMaker maker(1, 50);
  int contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const auto pair = maker.make(test::Family::General, rng);
    const Shape A = make_convex_hull(box_corners(std::get<Box>(pair.A).half)).value();
    const Shape B = make_convex_hull(box_corners(std::get<Box>(pair.B).half)).value();
    const Manifold a = collide_once(pair.A, pair.X_WA, pair.B, pair.X_WB, pair.margin);
    const Manifold b = collide_once(A, pair.X_WA, B, pair.X_WB, pair.margin);
    const Manifold c = collide_once(pair.A, pair.X_WA, B, pair.X_WB, pair.margin);
    contacts += a.count > 0 ? 1 : 0;
    if (a.count == 0 || b.count == 0 || c.count == 0) {
      // Only a gap at the very margin may be seen differently.
      for (const Manifold& m : {a, b, c}) {
        if (m.count > 0) {
          EXPECT_NEAR(test::least_phi(m), pair.margin, 1e-13);
        }
      }
      continue;
    }
    // Two axes within the allowance of each other (1 um + 1e-3 of the depth) may be told apart differently.
    const double allowed = 1e-6 + 1e-3 * std::max(0.0, -test::least_phi(a));
    EXPECT_NEAR(test::least_phi(a), test::least_phi(b), allowed);
    EXPECT_NEAR(test::least_phi(a), test::least_phi(c), allowed);
  }
  EXPECT_GT(contacts, 500);
}

}  // namespace
}  // namespace snug::geometry
