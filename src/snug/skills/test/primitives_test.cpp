// Primitives: rows, switches and poses against what they promise.
#include "snug/skills/primitives.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/motion/test/demonstrator.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::skills {
namespace {

using motion::kRounding;

using std::numbers::pi;

/// A cup without sag of length 0.05 m in the middle of the upper face of a box that stands upright.
ToolFor rigid(const Vector3& size) {
  return [size](const Pose& X_WP) {
    return X_WP * Pose{exp_rotation(Vector3(0.0, pi, 0.0)), Vector3(0.0, 0.0, 0.5 * size.z() + 0.05)};
  };
}

TEST(ChooseCupOffset, FollowsTheMassAsFarAsTheFaceAllows) {
  const Vector3 size(0.2, 0.1, 0.06);
  EXPECT_TRUE(choose_cup_offset(Matrix3::Identity(), size, Vector3(0.02, 0.04, -0.01), 0.03)
                  .isApprox(Vector3(0.02, 0.02, 0.0), kRounding));
  // A face narrower than the lip: the middle.
  EXPECT_EQ(choose_cup_offset(Matrix3::Identity(), Vector3(0.2, 0.05, 0.06), Vector3(0.0, 0.01, 0.0), 0.03).y(), 0.0);
}

TEST(PickRows, PressFromAboveAndLiftWithVacuum) {
  PickIntent intent;
  intent.box = "BOX027";
  intent.X_WP = {Matrix3::Identity(), Vector3(0.1, 0.2, 0.05)};
  const auto rows = pick_rows(intent);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(motion::name_of(rows[0]), "PrePick(BOX027)");
  EXPECT_EQ(motion::name_of(rows[1]), "Box(BOX027)");
  EXPECT_EQ(motion::name_of(rows[2]), "PostPick(BOX027)");
  EXPECT_FALSE(rows[1].io.vacuum);
  EXPECT_TRUE(rows[2].io.vacuum);
  EXPECT_TRUE(rows[1].X_WE.p.isApprox(Vector3(0.1, 0.2, 0.1 + intent.length), kRounding));
  EXPECT_NEAR(rows[1].X_WE.R(2, 2), -1.0, kRounding);
}

TEST(LeaningPickRows, AreSquareToTheUppermostFaceHoweverItLeansAndEndLevel) {
  for (int i = 0; i < 24; ++i) {
    const double lean = 0.03 * i, way = 0.9 * i;  // to 40 degrees, all around
    SCOPED_TRACE(lean);
    PickIntent intent;
    intent.box = "BOX027";
    intent.size = Vector3(0.2, 0.1, 0.06);
    intent.cup_offset_P = Vector3(0.01, -0.02, 0.0);
    const Matrix3 R_WP = exp_rotation(Vector3(0.0, 0.0, 0.4 * i)) * exp_rotation(Vector3(0.5 * pi * (i % 4), 0.0, 0.0));
    intent.X_WP = {exp_rotation(lean * Vector3(std::cos(way), std::sin(way), 0.0)) * R_WP, Vector3(0.1, 0.2, 0.05)};
    intent.cup_offset_P =
        intent.cup_offset_P - R_WP.transpose().col(2).dot(intent.cup_offset_P) * R_WP.transpose().col(2);
    EXPECT_TRUE((leveling(intent.X_WP.R) * intent.X_WP.R).isApprox(R_WP, 1e-9)) << "what leant it is undone";
    const auto rows = leaning_pick_rows(intent, 0.03);
    ASSERT_EQ(rows.size(), 5u);
    const Vector3 normal = intent.X_WP.R * R_WP.transpose().col(2);
    const Pose pick = rows[2].X_WE, off = rows[3].X_WE;
    EXPECT_NEAR(pick.R.col(2).dot(normal), -1.0, kRounding);
    const Vector3 lip_P = intent.X_WP.inverse() * (pick.p - intent.length * normal);
    const Vector3 up_P = R_WP.transpose().col(2);
    EXPECT_NEAR(lip_P.dot(up_P), 0.5 * intent.size.dot(up_P.cwiseAbs()), kRounding) << "on the face";
    EXPECT_TRUE((lip_P - lip_P.dot(up_P) * up_P).isApprox(intent.cup_offset_P, 1e-6));
    EXPECT_TRUE((off.p - pick.p).isApprox(0.03 * normal, 1e-6));
    EXPECT_NEAR(rows[0].X_WE.R(2, 2), -1.0, kRounding);
    EXPECT_NEAR(rows[4].X_WE.R(2, 2), -1.0, kRounding);
    EXPECT_FALSE(rows[2].io.vacuum);
    EXPECT_TRUE(rows[3].io.vacuum);
  }
}

TEST(FlipRows, EndFlatOnTheSideThatFacedAway) {
  FlipIntent intent;
  intent.size = Vector3(0.2, 0.12, 0.1);
  intent.p_WF = Vector3(0.3, 0.1, 0.02);
  intent.params.press = 0.0;
  intent.params.tilt = 0.5 * pi;
  intent.X_PE = {exp_rotation(Vector3(0.0, pi, 0.0)), Vector3(0.0, 0.0, 0.1)};
  intent.tool_for = rigid(intent.size);
  const auto rows = flip_rows(intent);
  ASSERT_EQ(rows.size(), 7u);
  // The side toward +x ends up: P's x axis.
  EXPECT_TRUE(flipped(Matrix3::Identity(), Vector3::UnitX()).col(0).isApprox(Vector3::UnitZ(), kRounding));
  const Pose X_WP = rows[3].X_WE * intent.X_PE.inverse();
  EXPECT_TRUE(X_WP.R.isApprox(flipped(Matrix3::Identity(), Vector3::UnitX()), 1e-9));
  EXPECT_NEAR(X_WP.p.z() + lowest_corner(X_WP.R, intent.size), intent.p_WF.z(), 1e-9);
  EXPECT_NEAR(X_WP.p.x(), intent.p_WF.x() + intent.params.dragged, 1e-9);
  // Before, no corner is under the surface.
  for (int i = 0; i < 2; ++i) {
    const Pose X = rows[static_cast<std::size_t>(i)].X_WE * intent.X_PE.inverse();
    EXPECT_GT(X.p.z() + lowest_corner(X.R, intent.size), intent.p_WF.z()) << i;
  }
  EXPECT_TRUE(rows[4].io.vacuum);
  EXPECT_FALSE(rows[5].io.vacuum);
  EXPECT_EQ(rows[4].X_WE, rows[5].X_WE);
}

TEST(PlaceRows, SlideAgainstNeighboursFromTheFreeSide) {
  PlaceIntent intent;
  intent.box = "BOX014";
  intent.X_WP = {Matrix3::Identity(), Vector3(0.5, 0.0, 0.05)};
  intent.tool_for = rigid(intent.size);
  intent.travel_bottom = 0.4;
  intent.entry_bottom = 0.3;
  intent.come_from = Vector3(0.01, 0.0, 0.0);
  intent.overtravel = Vector3(-0.005, 0.0, 0.0);
  const auto rows = place_rows(intent);
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_NEAR(rows[0].X_WE.p.x(), 0.51, kRounding);
  EXPECT_NEAR(rows[2].X_WE.p.x(), 0.51, kRounding);
  EXPECT_NEAR(rows[3].X_WE.p.x(), 0.495, kRounding);
  EXPECT_NEAR(rows[2].X_WE.p.z(), 0.1 + intent.params.slide_gap + 0.05, kRounding);
  EXPECT_TRUE(rows[4].io.vacuum);
  EXPECT_TRUE(rows[5].io.blow_off);
  EXPECT_GE(rows[6].X_WE.p.z(), intent.travel_bottom);
}

TEST(PlaceRows, EnterASlotOneSideFirstAndEndLevel) {
  PlaceIntent intent;
  intent.X_WP = {Matrix3::Identity(), Vector3(0.5, 0.0, 0.05)};
  intent.tool_for = rigid(intent.size);
  intent.travel_bottom = 0.4;
  intent.tilted = TiltedEntry{Vector3::UnitX(), Vector3(-0.004, 0.0, 0.0), 0.1};
  const auto rows = place_rows(intent);
  ASSERT_EQ(rows.size(), 8u);
  const Pose X_PE = rigid(intent.size)(Pose{});
  const Pose X_WP = rows[3].X_WE * X_PE.inverse();
  EXPECT_NEAR(X_WP.p.z() + lowest_corner(X_WP.R, intent.size), 0.085, 1e-9);
  const Vector3 low = X_WP * Vector3(0.05, 0.0, -0.05), high = X_WP * Vector3(-0.05, 0.0, -0.05);
  EXPECT_LT(low.z(), high.z());
  EXPECT_NEAR(low.x(), 0.546, 1e-9);  // where that corner will be, and the push
  EXPECT_NEAR(angle_between((rows[4].X_WE * X_PE.inverse()).R, Matrix3::Identity()), 0.0, 1e-9);
}

}  // namespace
}  // namespace snug::skills
