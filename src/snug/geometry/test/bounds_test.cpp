// bounds: contains the shape and touches it on all six sides.
#include <gtest/gtest.h>

#include "random_pair.hpp"
#include "snug/geometry/bounds.hpp"

namespace snug::geometry {
namespace {

TEST(Bounds, OfABoxTouchesItsExtremeCorners) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Box box{{rng.uniform(0.01, 1.0), rng.uniform(0.01, 1.0), rng.uniform(0.01, 1.0)}};
    const Pose X_WG{test::random_rotation(rng), {rng.normal(), rng.normal(), rng.normal()}};
    Vector3 low = Vector3::Constant(1e9);
    Vector3 high = -low;
    for (int v = 0; v < 8; ++v) {
      const Vector3 corner = box.half.cwiseProduct(
          Vector3((v & 1) != 0 ? 1.0 : -1.0, (v & 2) != 0 ? 1.0 : -1.0, (v & 4) != 0 ? 1.0 : -1.0));
      low = low.cwiseMin(X_WG * corner);
      high = high.cwiseMax(X_WG * corner);
    }
    const Aabb aabb = bounds(box, X_WG);
    EXPECT_LT((aabb.lower - low).norm(), 1e-14);  // rounding of metres
    EXPECT_LT((aabb.upper - high).norm(), 1e-14);
  }
}

TEST(Bounds, OfACapsuleIsItsSegmentGrownByTheRadius) {
  const Aabb aabb = bounds(Capsule{0.5, 0.1}, {exp_rotation({0, 1.5707963267948966, 0}), {1, 2, 3}});
  EXPECT_LT((aabb.lower - Vector3(0.4, 1.9, 2.9)).norm(), 1e-15);
  EXPECT_LT((aabb.upper - Vector3(1.6, 2.1, 3.1)).norm(), 1e-15);
}

TEST(Bounds, ThatDoNotOverlapMeanNoContact) {
  Rng rng(2);
  const test::PairMaker maker(1, 50);
  for (int i = 0; i < 20000; ++i) {
    const auto pair = maker.make(static_cast<test::Family>(i % test::kFamilies), rng);
    PairCache cache;
    Manifold m;
    collide(pair.A, pair.X_WA, pair.B, pair.X_WB, 0.0, cache, m);
    if (m.count == 0) continue;
    // Touching to rounding counts as contact on one side only.
    EXPECT_TRUE(bounds(pair.A, pair.X_WA).inflated(1e-15).overlaps(bounds(pair.B, pair.X_WB).inflated(1e-15)));
  }
}

}  // namespace
}  // namespace snug::geometry
