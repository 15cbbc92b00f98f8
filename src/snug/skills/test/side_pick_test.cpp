// Side pick and set down: rows, switches and poses against what they promise.
#include "snug/skills/side_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/motion/test/demonstrator.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/skills/unwinding.hpp"

namespace snug::skills {
namespace {

using motion::kRounding;

using std::numbers::pi;

TEST(SidePickRotation, PointsAtTheFaceAndIsUprightAgainWhenTheFaceIsUp) {
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const double heading = rng.uniform(-pi, pi), yaw = rng.uniform(-pi, pi), incline = rng.uniform(0.0, 0.3);
    const Vector3 face(std::cos(heading), std::sin(heading), 0.0);
    const Matrix3 R_WE = side_pick_rotation(face, yaw, incline);
    EXPECT_NEAR(R_WE.col(2).dot(-face), std::cos(incline), kRounding);
    EXPECT_NEAR(R_WE(2, 2), -std::sin(incline), kRounding) << "it comes from above";
    // The turn that brings the face up brings the tool, pressed squarely, upright to the yaw asked for.
    const Matrix3 R_WE_up = face_up(side_pick_rotation(face, yaw, 0.0), face);
    ASSERT_TRUE(motion::yaw_of(R_WE_up));
    EXPECT_NEAR(std::remainder(*motion::yaw_of(R_WE_up) - yaw, 2.0 * pi), 0.0, 1e-9);
    EXPECT_NEAR((face_up(Matrix3::Identity(), face) * face).z(), 1.0, kRounding);
  }
}

TEST(SidePickRows, ComeLowBeforeTheFaceTouchItAndLiftTheBoxAsItStood) {
  SidePickIntent intent;
  intent.box = "BOX013";
  intent.size = Vector3(0.2, 0.12, 0.1);
  intent.X_WP = {Matrix3::Identity(), Vector3(0.3, 0.1, 0.05)};
  intent.face = -Vector3::UnitY();
  const auto rows = side_pick_rows(intent);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(motion::name_of(rows[0]), "PrePick(BOX013)");
  EXPECT_EQ(motion::name_of(rows[3]), "Box(BOX013)");
  EXPECT_EQ(motion::name_of(rows[4]), "PostPick(BOX013)");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FALSE(rows[i].io.vacuum) << i;
  EXPECT_TRUE(rows[4].io.vacuum);
  const Vector3 touched = rows[3].X_WE.p + intent.length * rows[3].X_WE.R.col(2);
  EXPECT_TRUE(touched.isApprox(Vector3(0.3, 0.04, 0.05), kRounding));
  EXPECT_TRUE((rows[2].X_WE.p - rows[3].X_WE.p).isApprox(Vector3(0.0, -intent.params.stand_off, 0.0), kRounding));
  EXPECT_TRUE((rows[4].X_WE.p - rows[3].X_WE.p).isApprox(Vector3(0.0, 0.0, intent.lift), kRounding));
  EXPECT_EQ(rows[4].X_WE.R, rows[3].X_WE.R);
  // Only the first row is upright, so that yaw and tilt are turned one after the other.
  EXPECT_TRUE(motion::yaw_of(rows[0].X_WE.R));
  EXPECT_FALSE(motion::yaw_of(rows[1].X_WE.R));
  EXPECT_EQ(rows[0].X_WE.p, rows[1].X_WE.p);
  intent.again = true;
  const auto again = side_pick_rows(intent);
  EXPECT_EQ(motion::name_of(again[0]), "PreRePick(BOX013)");
  EXPECT_EQ(motion::name_of(again[3]), "RePick(BOX013)");
  EXPECT_EQ(motion::name_of(again[4]), "PostRePick(BOX013)");
}

TEST(SidePickRows, FollowABoxThatStandsALittleTurned) {
  SidePickIntent intent;
  intent.size = Vector3(0.2, 0.12, 0.1);
  const double yaw = 0.05;
  intent.X_WP = {exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(0.3, 0.1, 0.05)};
  intent.face = Vector3::UnitX();
  const auto rows = side_pick_rows(intent);
  EXPECT_NEAR(rows[3].X_WE.R.col(2).head<2>().normalized().dot(-Vector3(std::cos(yaw), std::sin(yaw), 0.0).head<2>()),
              1.0, kRounding);
}

TEST(SetDownRows, PutTheBoxOnTheSurfaceAndLetGo) {
  SetDownIntent intent;
  intent.box = "BOX030";
  intent.size = Vector3(0.2, 0.12, 0.1);
  intent.X_WP = {Matrix3::Identity(), Vector3(0.3, 0.1, 0.05)};
  intent.tool_for = [](const Pose& X_WP) {
    return X_WP * Pose{exp_rotation(Vector3(0.0, pi, 0.0)), Vector3(0.0, 0.0, 0.1)};
  };
  const auto rows = set_down_rows(intent);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_NEAR(rows[0].X_WE.p.z(), intent.travel_bottom + 0.05 + 0.1, kRounding);
  EXPECT_NEAR(rows[2].X_WE.p.z(), 0.15 - intent.params.press, kRounding);
  EXPECT_TRUE(rows[2].io.vacuum);
  EXPECT_FALSE(rows[3].io.vacuum);
  EXPECT_TRUE(rows[3].io.blow_off);
  EXPECT_EQ(rows[2].X_WE, rows[3].X_WE);
  EXPECT_GT(rows[4].X_WE.p.z(), rows[0].X_WE.p.z());
}

}  // namespace
}  // namespace snug::skills
