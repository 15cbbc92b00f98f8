// cast: exact on boxes, hulls and round shapes against a ray at a time.
#include "snug/camera/cast.hpp"

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"
#include "snug/geometry/convex_hull.hpp"

namespace snug::camera {
namespace {

Pose random_pose(Rng& rng, double spread, double depth) {
  const Vector3 turn(rng.normal(), rng.normal(), rng.normal());
  return {exp_rotation(2.0 * turn), Vector3(rng.uniform(-spread, spread), rng.uniform(-spread, spread), depth)};
}

CastView small_view() {
  CastView view;
  view.optics = {200.0, 190.0, 79.5, 59.5};
  view.rows = 120;
  view.cols = 160;
  return view;
}

/// Depth of a box by the slabs of its three axes: the textbook's way, ray by ray; 0 when missed.
double slab_depth(const geometry::Box& box, const Pose& X_CG, const Vector3& ray) {
  const Pose X_GC = X_CG.inverse();
  const Vector3 o = X_GC.p, d = X_GC.R * ray;
  double in = 0.0, out = 1e9;
  for (int i = 0; i < 3; ++i) {
    const double a = (-box.half(i) - o(i)) / d(i), b = (box.half(i) - o(i)) / d(i);
    in = std::max(in, std::min(a, b));
    out = std::min(out, std::max(a, b));
  }
  return in <= out ? in : 0.0;
}

TEST(Cast, SeesBoxesWhereARayThroughTheirSlabsDoes) {
  Rng rng = Rng(3).split("boxes");
  const CastView view = small_view();
  for (int scene_index = 0; scene_index < 20; ++scene_index) {
    Scene scene;
    for (int i = 0; i < 6; ++i)
      add_box(scene, "b", random_pose(rng, 0.3, rng.uniform(0.6, 1.4)),
              2.0 * Vector3(rng.uniform(0.02, 0.15), rng.uniform(0.02, 0.15), rng.uniform(0.02, 0.15)));
    const Cast seen = cast(scene, view);
    int hits = 0;
    for (int r = 0; r < view.rows; ++r)
      for (int c = 0; c < view.cols; ++c) {
        const Vector3 ray((c - view.optics.cx) / view.optics.fx, (r - view.optics.cy) / view.optics.fy, 1.0);
        double z = 0.0;
        for (const SceneShape& shape : scene.shapes) {
          const double s = slab_depth(std::get<geometry::Box>(shape.shape), shape.X_WG, ray);
          if (s > 0.0 && (z == 0.0 || s < z)) z = s;
        }
        const float w = seen.inverse_depth(r, c);
        hits += z > 0.0 ? 1 : 0;
        // Rounding of single precision: 1e-7 of the depth, at grazing faces some tens of that. A ray along an edge may
        // miss.
        if (z > 0.0 && w > 0.0F) {
          ASSERT_NEAR(1.0 / w, z, 3e-6) << r << " " << c;
        }
        if ((z > 0.0) != (w > 0.0F)) {
          SCOPED_TRACE(scene_index);
          double near = 1e9;  // how far the ray passes from being a hit or miss: in and out almost meet
          for (const SceneShape& shape : scene.shapes)
            for (const double grow : {-1e-9, 1e-9}) {
              geometry::Box box = std::get<geometry::Box>(shape.shape);
              box.half.array() += grow;
              if ((slab_depth(box, shape.X_WG, ray) > 0.0) == (w > 0.0F)) near = 0.0;
            }
          EXPECT_EQ(near, 0.0) << r << " " << c;
        }
      }
    EXPECT_GT(hits, 500);
  }
}

TEST(Cast, BoxAsHullIsSeenAsTheBox) {
  Rng rng = Rng(4).split("hull");
  const CastView view = small_view();
  for (int i = 0; i < 10; ++i) {
    const Vector3 half(rng.uniform(0.03, 0.2), rng.uniform(0.03, 0.2), rng.uniform(0.03, 0.2));
    const Pose X_WB = random_pose(rng, 0.1, 1.0);
    std::vector<Vector3> corners;
    for (int k = 0; k < 8; ++k)
      corners.push_back(
          half.cwiseProduct(Vector3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1)));
    Scene box, hull;
    add_box(box, "b", X_WB, 2.0 * half);
    add_body(hull, "b", X_WB, {{*geometry::make_convex_hull(corners), {}}});
    const Cast a = cast(box, view), b = cast(hull, view);
    int different = 0;
    for (std::size_t k = 0; k < a.inverse_depth.values().size(); ++k)
      different += std::abs(a.inverse_depth.values()[k] - b.inverse_depth.values()[k]) > 1e-5F ? 1 : 0;
    EXPECT_LE(different, 2);  // rays along an edge
  }
}

TEST(Cast, BallAndCylinderHaveTheirClosedForms) {
  const CastView view = small_view();
  Scene scene;
  add_body(scene, "ball", {Matrix3::Identity(), Vector3(0, 0, 1.0)}, {{geometry::Capsule{0.0, 0.2}, {}}});
  const Cast ball = cast(scene, view);
  for (int r = 0; r < view.rows; r += 7)
    for (int c = 0; c < view.cols; c += 7) {
      const Vector3 ray((c - view.optics.cx) / view.optics.fx, (r - view.optics.cy) / view.optics.fy, 1.0);
      const double b = ray.z(), a = ray.squaredNorm(), d = b * b - a * (1.0 - 0.04);
      EXPECT_EQ(ball.inverse_depth(r, c) > 0.0F, d >= 0.0);
      if (d < 0.0) continue;
      const double z = (b - std::sqrt(d)) / a;
      EXPECT_NEAR(1.0 / ball.inverse_depth(r, c), z, 1e-6);
      const Vector3 n = (z * ray - Vector3(0, 0, 1.0)).normalized();
      EXPECT_LT((normal_at(ball, scene, view, r, c) - n).norm(), 1e-5);
    }
  Scene disc;  // a cylinder seen along its axis: a disc of radius 0.1 at 0.9 m
  add_body(disc, "cylinder", {Matrix3::Identity(), Vector3(0, 0, 1.0)}, {{geometry::Cylinder{0.1, 0.1}, {}}});
  const Cast end = cast(disc, view);
  for (int r = 0; r < view.rows; ++r)
    for (int c = 0; c < view.cols; ++c) {
      const double radius =
          0.9 * std::hypot((c - view.optics.cx) / view.optics.fx, (r - view.optics.cy) / view.optics.fy);
      if (std::abs(radius - 0.1) < 1e-9) continue;
      EXPECT_EQ(end.inverse_depth(r, c) > 0.0F, radius < 0.1);
      if (radius < 0.1) {
        EXPECT_NEAR(1.0 / end.inverse_depth(r, c), 0.9, 1e-6);
      }
    }
}

TEST(Cast, NoRaySlipsThroughTheSeamBetweenBoxesThatTouch) {
  Scene scene;
  for (int i = -20; i < 20; ++i)
    add_box(scene, "b", {Matrix3::Identity(), Vector3(0.05 * i + 0.025, 0.0, 1.0)}, Vector3(0.05, 1.0, 0.1));
  const Cast seen = cast(scene, small_view());
  for (const float w : seen.inverse_depth.values()) EXPECT_GT(w, 0.0F);
}

TEST(Cast, GivesTheSameBytesAtAnyNumberOfThreads) {
  Rng rng = Rng(5).split("threads");
  Scene scene;
  for (int i = 0; i < 30; ++i)
    add_box(scene, "b", random_pose(rng, 0.4, rng.uniform(0.5, 1.5)), Vector3(0.1, 0.2, 0.06));
  const Cast one = cast(scene, small_view(), 1), three = cast(scene, small_view(), 3);
  EXPECT_EQ(one.inverse_depth, three.inverse_depth);
  EXPECT_EQ(one.surface, three.surface);
}

TEST(Cast, DoesNotSeeWhatIsBehindOrAroundIt) {
  Scene scene;
  add_box(scene, "behind", {Matrix3::Identity(), Vector3(0, 0, -1.0)}, Vector3(0.5, 0.5, 0.5));
  add_box(scene, "around", Pose{}, Vector3(0.1, 0.1, 0.1));
  add_body(scene, "round", Pose{}, {{geometry::Capsule{0.1, 0.1}, {}}, {geometry::Cylinder{0.1, 0.1}, {}}});
  const auto frame = cast(scene, small_view());  // lives as long as the loop over a part of it
  for (const float w : frame.inverse_depth.values()) EXPECT_EQ(w, 0.0F);
}

}  // namespace
}  // namespace snug::camera
