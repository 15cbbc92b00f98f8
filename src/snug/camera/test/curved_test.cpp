// Rays against capsules and cylinders: against the slow way along the ray, in any frame, at ends and beside them.
#include "snug/camera/internal/curved.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"

namespace snug::camera::internal {
namespace {

const geometry::Shape kCapsule = geometry::Capsule{0.15, 0.06}, kCylinder = geometry::Cylinder{0.15, 0.06};

Vector3 draw3(Rng& rng, double size) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return size * Vector3(x, y, z);
}

/// A pose some 1 m before the camera, and a ray that goes about there.
struct Shot {
  explicit Shot(Rng& rng) {
    X_CG = {exp_rotation(draw3(rng, 2.0)), Vector3(0.0, 0.0, 1.0) + draw3(rng, 0.05)};
    ray = Vector3(X_CG.p + draw3(rng, 0.08)) / X_CG.p.z();
  }
  [[nodiscard]] Vector3 at(double s) const { return X_CG.inverse() * Vector3(s * ray); }
  Pose X_CG;
  Vector3 ray;
};

TEST(CurvedHit, IsTheFirstPointInsideTheSlowWay) {
  Rng rng = Rng(1).split("hit");
  for (const geometry::Shape& shape : {kCapsule, kCylinder}) {
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      SCOPED_TRACE(i);
      const Shot shot(rng);
      const double s = hit(shape, shot.X_CG, shot.ray);
      constexpr double kStep = 1e-3;
      double first = 0.0;
      for (double slow = 0.5; slow < 1.6 && first == 0.0; slow += kStep)
        if (is_inside(shape, shot.at(slow))) first = slow;
      if (first > 0.0) {
        ++hits;
        EXPECT_LE(s, first);
        EXPECT_GE(s, first - kStep * 1.0001);
      }
      if (s > 0.0) {
        // On the surface: a little before it outside, a little behind it inside or gone again (a ray that grazes it).
        EXPECT_FALSE(is_inside(shape, shot.at(s - 1e-9)));
        EXPECT_TRUE(is_inside(shape, shot.at(s + 1e-9)) || first == 0.0);
      }
    }
    EXPECT_GT(hits, 60);
  }
}

TEST(CurvedHit, IsTheSameInAnyFrameAndForALongerRay) {
  Rng rng = Rng(2).split("frames");
  for (int i = 0; i < 100; ++i) {
    const Shot shot(rng);
    for (const geometry::Shape& shape : {kCapsule, kCylinder}) {
      const double s = hit(shape, shot.X_CG, shot.ray);
      const Pose turn{exp_rotation(draw3(rng, 1.0)), Vector3::Zero()};  // about the camera
      EXPECT_NEAR(hit(shape, turn * shot.X_CG, turn.R * shot.ray), s, 1e-9);
      EXPECT_NEAR(hit(shape, shot.X_CG, 4.0 * shot.ray), 0.25 * s, 1e-12);
      // Round shapes are the same when they are turned about their axis or end for end.
      const Pose about{exp_rotation(Vector3(0.0, 0.0, 1.3)), Vector3::Zero()},
          over{exp_rotation(Vector3(3.14159265358979, 0.0, 0.0)), Vector3::Zero()};
      EXPECT_NEAR(hit(shape, shot.X_CG * about, shot.ray), s, 1e-9);
      EXPECT_NEAR(hit(shape, shot.X_CG * over, shot.ray), s, 1e-9);
    }
  }
}

TEST(CurvedHit, IsNoneBehindTheCameraAndBesideTheShape) {
  const Vector3 ahead(0.0, 0.0, 1.0);
  for (const geometry::Shape& shape : {kCapsule, kCylinder}) {
    EXPECT_EQ(hit(shape, {Matrix3::Identity(), Vector3(0.0, 0.0, -1.0)}, ahead), 0.0);
    EXPECT_EQ(hit(shape, {Matrix3::Identity(), Vector3(0.0601, 0.0, 1.0)}, ahead), 0.0);
    EXPECT_GT(hit(shape, {Matrix3::Identity(), Vector3(0.0599, 0.0, 1.0)}, ahead), 0.0);
  }
  // Along the axis: the end, flat at 0.85 m, or round 60 mm nearer.
  EXPECT_DOUBLE_EQ(hit(kCylinder, {Matrix3::Identity(), ahead}, ahead), 0.85);
  EXPECT_DOUBLE_EQ(hit(kCapsule, {Matrix3::Identity(), ahead}, ahead), 0.79);
  // Across it: the mantle; level with the very end both are seen, a little further only the capsule.
  const Matrix3 across = exp_rotation(Vector3(0.5 * 3.14159265358979323846, 0.0, 0.0));
  for (const geometry::Shape& shape : {kCapsule, kCylinder})
    EXPECT_NEAR(hit(shape, {across, Vector3(0.0, 0.149, 1.0)}, ahead), 0.94, 1e-12);
  EXPECT_EQ(hit(kCylinder, {across, Vector3(0.0, 0.16, 1.0)}, ahead), 0.0);
  EXPECT_NEAR(hit(kCapsule, {across, Vector3(0.0, 0.16, 1.0)}, ahead), 1.0 - std::sqrt(0.06 * 0.06 - 0.01 * 0.01),
              1e-12);
}

TEST(CurvedNormal, IsOutwardAndAcrossTheSurface) {
  Rng rng = Rng(3).split("normals");
  for (const geometry::Shape& shape : {kCapsule, kCylinder}) {
    for (int i = 0; i < 400; ++i) {
      const Shot shot(rng);
      const double s = hit(shape, shot.X_CG, shot.ray);
      if (s == 0.0) continue;
      const Vector3 p = shot.at(s), n = curved_normal(shape, p);
      EXPECT_NEAR(n.norm(), 1.0, 1e-12);
      EXPECT_FALSE(is_inside(shape, p + 1e-6 * n));
      EXPECT_TRUE(is_inside(shape, p - 1e-6 * n));
      EXPECT_LT(n.dot(shot.X_CG.R.transpose() * shot.ray), 0.0) << "seen from before it";
      // A tenth of a millimetre along the surface leaves it by the square of that over the radius.
      const Vector3 along = n.unitOrthogonal();
      const Vector3 near = p + 1e-4 * along;
      EXPECT_TRUE(is_inside(shape, near - 2e-7 * n) || std::holds_alternative<geometry::Cylinder>(shape));
    }
  }
}

TEST(CurvedExtent, HoldsTheShapeAndNoMore) {
  Rng rng = Rng(4).split("extent");
  for (const geometry::Shape& shape : {kCapsule, kCylinder}) {
    const Vector3 half = half_extent(shape);
    Vector3 reached = Vector3::Zero();
    for (int i = 0; i < 40'000; ++i) {
      const Vector3 p = 1.2 * half.cwiseProduct(Vector3(draw3(rng, 0.4)));
      if (!is_inside(shape, p)) continue;
      EXPECT_TRUE((p.cwiseAbs().array() <= half.array() + 1e-12).all());
      reached = reached.cwiseMax(p.cwiseAbs());
    }
    EXPECT_GT((reached.cwiseQuotient(half)).minCoeff(), 0.85);
  }
  EXPECT_EQ(half_extent(kCylinder), Vector3(0.06, 0.06, 0.15));
  EXPECT_NEAR(half_extent(kCapsule).z(), 0.21, 1e-15);
}

}  // namespace
}  // namespace snug::camera::internal
