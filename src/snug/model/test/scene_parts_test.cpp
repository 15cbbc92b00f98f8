// Container walls, boxes at the aligner, holder paths.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/model/body.hpp"
#include "snug/model/parcel.hpp"

namespace snug::model {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ContainerWalls, EncloseTheInnerSpaceWithoutGapOrOverlap) {
  Container container;
  container.inner_size = {0.37, 0.57, 0.25};
  container.wall_thickness = 0.015;
  container.floor_thickness = 0.018;
  const std::vector<PlacedShape> walls = make_walls(container);
  ASSERT_EQ(walls.size(), 5u);
  double volume = 0.0;
  for (const PlacedShape& wall : walls) volume += 8.0 * std::get<geometry::Box>(wall.shape).half.prod();
  // Outer block less the inner space: equal only if nothing overlaps and nothing is missing.
  EXPECT_NEAR(volume, 0.400 * 0.600 * 0.268 - 0.37 * 0.57 * 0.25, 1e-15);
  for (const PlacedShape& wall : walls) {
    const Vector3 half = std::get<geometry::Box>(wall.shape).half;
    const Vector3 gap = (wall.X_BG.p - Vector3(0, 0, 0.125)).cwiseAbs() - half - Vector3(0.185, 0.285, 0.125);
    EXPECT_NEAR(gap.maxCoeff(), 0.0, 1e-15);  // touches the inner space, does not enter it
  }
}

TEST(StandingPose, PutsTheCornerOfABoxAtTheAlignersOriginForEveryOrientation) {
  Aligner aligner;
  aligner.X_WA = {exp_rotation({0, 0, 2.269}), {-0.353, -0.418, -0.0355}};
  aligner.support_height = -0.105;
  const Vector3 size(0.203, 0.198, 0.097);
  for (const UpAxis up : {UpAxis::X, UpAxis::Y, UpAxis::Z})
    for (const int sign : {1, -1})
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Matrix3 R_AP = standing_rotation(up, sign, quarter * 0.5 * kPi);
        EXPECT_NEAR(R_AP.determinant(), 1.0, 1e-15);
        EXPECT_EQ(R_AP(2, static_cast<int>(up)), sign);
        const Pose X_WP = standing_pose(aligner, size, R_AP);
        const Pose X_AP = aligner.X_WA.inverse() * X_WP;
        Vector3 low_A = Vector3::Constant(1e9);
        double low_W = 1e9;
        for (int i = 0; i < 8; ++i) {
          const Vector3 corner =
              0.5 * Vector3((i & 1 ? 1 : -1) * size.x(), (i & 2 ? 1 : -1) * size.y(), (i & 4 ? 1 : -1) * size.z());
          low_A = low_A.cwiseMin(X_AP * corner);
          low_W = std::min(low_W, (X_WP * corner).z());
        }
        EXPECT_NEAR(low_A.x(), 0.0, 1e-15);
        EXPECT_NEAR(low_A.y(), 0.0, 1e-15);
        EXPECT_NEAR(low_W, -0.105, 1e-15);
      }
}

TEST(StandingRotation, KnowsWhereTheHeavySideOfABoxOnEdgeIs) {
  // X up at yaw 0: y and z of the box along Ax and Ay, so the plate (body -z) faces the corner; half a turn: away.
  EXPECT_TRUE(has_heavy_side_at_corner(standing_rotation(UpAxis::X, 1, 0.0)));
  EXPECT_FALSE(has_heavy_side_at_corner(standing_rotation(UpAxis::X, 1, kPi)));
  EXPECT_FALSE(has_heavy_side_at_corner(standing_rotation(UpAxis::X, 1, 0.5 * kPi)));
  EXPECT_TRUE(has_heavy_side_at_corner(standing_rotation(UpAxis::X, 1, -0.5 * kPi)));
  EXPECT_TRUE(has_heavy_side_at_corner(standing_rotation(UpAxis::Z, 1, kPi)));
}

Spring make_path() {
  Spring spring;
  spring.X_WH.p = {0.6, 0, 0.2};
  spring.moves = {SwingMove{0.5, 1.0, {0, 0, 0}, {0, 0, 1}, kPi / 3.0},
                  StraightMove{2.0, 1.5, {exp_rotation({0.3, 0.2, 0.1}), {0.1, 0.2, 0.3}}}};
  return spring;
}

TEST(HolderPath, ReachesItsEndsAndRestsBetweenMoves) {
  const Spring spring = make_path();
  EXPECT_EQ(holder_at(spring, 0.0).X_WH, spring.X_WH);
  EXPECT_EQ(holder_at(spring, 0.5).V_WH, Twist{});
  const HolderState between = holder_at(spring, 1.75);
  EXPECT_LT((between.X_WH.p - Vector3(0.3, 0.6 * std::sin(kPi / 3.0), 0.2)).norm(), 1e-15);
  EXPECT_LT(as_vector(between.V_WH).norm(), 1e-15);
  EXPECT_EQ(holder_at(spring, 3.5).X_WH, std::get<StraightMove>(spring.moves[1]).X_WH);
  EXPECT_EQ(holder_at(spring, 100.0).X_WH, std::get<StraightMove>(spring.moves[1]).X_WH);
}

TEST(HolderPath, HasTheTwistOfItsPose) {
  const Spring spring = make_path();
  const double h = 1e-5;
  for (double t = 0.01; t < 4.0; t += 0.037) {
    SCOPED_TRACE(t);
    const Pose before = holder_at(spring, t - h).X_WH;
    const Pose after = holder_at(spring, t + h).X_WH;
    const Twist V = holder_at(spring, t).V_WH;
    // Central differences: h^2 times the third derivative (below 60/s^3 here) and rounding 1e-16 / h.
    EXPECT_LT(((after.p - before.p) / (2 * h) - V.linear).norm(), 1e-7);
    EXPECT_LT((log_rotation(after.R * before.R.transpose()) / (2 * h) - V.angular).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace snug::model
