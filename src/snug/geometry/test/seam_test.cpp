// Seams: a box that slides over flush boxes feels the floor and nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::geometry {
namespace {

using test::at;
using test::collide_once;

constexpr double kMargin = 2e-3;
const Box kTile{{0.1, 0.3, 0.02}};  // tiles lie side by side in x, tops at z = 0
const Box kSlider{{0.05, 0.04, 0.03}};

struct Support {
  int points = 0;  ///< counted in both argument orders
  bool vertical_only = true;
};

/// Contacts of the slider with three tiles whose seams are at x = -0.1 and x = 0.1.
Support support_at(const Pose& X_WS) {
  Support support;
  for (const double x : {-0.2, 0.0, 0.2}) {
    for (const bool slider_first : {false, true}) {
      const Pose X_WT = at(x, 0, -kTile.half.z());
      const Manifold m = slider_first ? collide_once(kSlider, X_WS, kTile, X_WT, kMargin)
                                      : collide_once(kTile, X_WT, kSlider, X_WS, kMargin);
      if (m.count == 0) continue;
      support.points += m.count;
      // Vertical to what the slider itself is tilted by.
      if (std::abs(m.n_AB_W.z()) < 0.999) support.vertical_only = false;
    }
  }
  return support;
}

void expect_floor_only(double x, double z, double yaw) {
  const Pose X_WS = at(x, 0.01, kSlider.half.z() + z, {0, 0, yaw});
  const Support support = support_at(X_WS);
  EXPECT_TRUE(support.vertical_only) << "x " << x << " z " << z << " yaw " << yaw;
  EXPECT_GE(support.points, 8) << "x " << x << " z " << z << " yaw " << yaw;
}

TEST(Seam, BoxGlidingOverFlushTilesHasVerticalNormalsAtEveryTenthOfAMillimetre) {
  for (int i = -1000; i <= 1000; ++i) expect_floor_only(1e-4 * i, -1e-6, 0.0);
}

TEST(Seam, NoSideWallWhenTheBoxReachesOverTheSeamByNanometresToMicrometres) {
  const double at_seam = 0.1 - kSlider.half.x();  // the front of the slider is on the seam
  for (const double z : {-20e-6, -10e-6, -1e-6, -1e-9, 0.0, 1e-9, 1e-6}) {
    expect_floor_only(at_seam, z, 0.0);
    for (double over = 1e-9; over < 60e-6; over *= 1.05) {
      expect_floor_only(at_seam + over, z, 0.0);
      expect_floor_only(at_seam - over, z, 0.0);
      expect_floor_only(-at_seam - over, z, 0.0);
    }
  }
}

TEST(Seam, NoSideWallForATurnedBoxWhoseEdgeReachesOverTheSeam) {
  for (const double yaw : {1e-9, 1e-6, 1e-3, 0.3, 0.785398163397448, 1.2}) {
    const double reach = kSlider.half.x() * std::cos(yaw) + kSlider.half.y() * std::sin(yaw);
    for (double over = 1e-9; over < 2e-3; over *= 1.1) {
      expect_floor_only(0.1 - reach + over, -1e-6, yaw);
      expect_floor_only(0.1 - reach - over, -1e-6, yaw);
    }
  }
}

TEST(Seam, NoSideWallUnderRandomHairlineTilt) {
  Rng rng(21);
  for (int i = 0; i < 100000; ++i) {
    const double tilt = 1e-5;  // lifts or sinks the rims of the slider by less than a micrometre
    const Pose X_WS = at(rng.uniform(-0.1, 0.1), rng.uniform(-0.05, 0.05), kSlider.half.z() - 1e-6,
                         {tilt * rng.normal(), tilt * rng.normal(), rng.uniform(-1.0, 1.0)});
    const Support support = support_at(X_WS);
    ASSERT_TRUE(support.vertical_only) << i;
    ASSERT_GE(support.points, 6) << i;
  }
}

TEST(Seam, HairlineOverlapInHeightIsNoWall) {
  // A box as high as its neighbour, and 20 um lower: approaching from above-left it must pass over.
  for (const double apart : {1e-3, 1e-4, 1e-6, 0.0, -1e-6, -1e-5}) {
    const Manifold m = collide_once(kTile, at(0, 0, -kTile.half.z()), kSlider,
                                    at(0.1 + kSlider.half.x() + apart, 0, kSlider.half.z() - 20e-6), kMargin);
    for (int i = 0; i < m.count; ++i) EXPECT_LT(std::abs(m.n_AB_W.x()), 1e-3);
  }
}

TEST(Seam, ACornerPairIsNamed) {
  const Pose X_WT = at(0, 0, -kTile.half.z());
  const auto is_named = [&](double x, double z) {
    return collide_once(kTile, X_WT, kSlider, at(0.1 + kSlider.half.x() + x, 0, kSlider.half.z() + z), kMargin)
        .is_corner_pair;
  };
  EXPECT_TRUE(is_named(1e-3, 0.0));
  EXPECT_TRUE(is_named(1e-3, -20e-6));
  EXPECT_FALSE(is_named(1e-3, -1e-4));  // a wall
  EXPECT_FALSE(is_named(5e-3, 0.0));    // beyond the margin
  EXPECT_FALSE(is_named(-5e-2, 0.0));   // a floor
}

TEST(Seam, ARealStepIsAWall) {
  const Manifold m = collide_once(kTile, at(0, 0, -kTile.half.z()), kSlider,
                                  at(0.1 + kSlider.half.x() + 1e-4, 0, kSlider.half.z() - 1e-4), kMargin);
  ASSERT_EQ(m.count, 4);
  EXPECT_EQ(m.n_AB_W, Vector3::UnitX());
}

TEST(Seam, NeighboursStandingFlushStillPushEachOther) {
  // Two boxes of equal height side by side on a floor, touching: their side faces overlap fully.
  const Manifold m = collide_once(kSlider, at(0, 0, 0.03), kSlider, at(0.1 - 1e-6, 0, 0.03), kMargin);
  ASSERT_EQ(m.count, 4);
  EXPECT_EQ(std::abs(m.n_AB_W.x()), 1.0);
}

TEST(Seam, DepthGrowsWithoutAJumpLargerThanTheSlopWhenABoxSinksPastACorner) {
  // Sinking with 15 um of ledge: nothing at first, then a sideways push of no more than the ledge.
  const double ledge = 15e-6;
  for (double sink = 1e-6; sink < 1e-2; sink *= 1.3) {
    const Manifold m = collide_once(kTile, at(0, 0, -kTile.half.z()), kSlider,
                                    at(0.1 + kSlider.half.x() - ledge, 0, kSlider.half.z() - sink), kMargin);
    if (m.count == 0) continue;
    EXPECT_NEAR(test::least_phi(m), -ledge, 1e-12);
  }
}

}  // namespace
}  // namespace snug::geometry
