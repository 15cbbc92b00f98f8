// Plans of picks: where the cup presses, what is passed over, which way the tool is turned, and that it does not wind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/way.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/skills/item_plan.hpp"
#include "snug/skills/test/scene.hpp"

namespace snug::skills {
namespace {

using std::numbers::pi;

constexpr double kTravel = 0.12;  ///< m, z in W

CellLayout layout_at(double neutral_yaw) {
  CellLayout layout = make_layout(demonstrator(), std::nullopt);
  layout.neutral_yaw = neutral_yaw;
  return layout;
}

Vector3 random_point(Rng& rng, const Vector3& half) {
  return {rng.uniform(-half.x(), half.x()), rng.uniform(-half.y(), half.y()), rng.uniform(-half.z(), half.z())};
}

TEST(PlanPick, PressesUprightWithinTheFaceAsNearTheCentreOfMassAsItSeals) {
  Rng rng(41);
  const model::Scenario& scenario = demonstrator();
  const double radius = 0.5 * scenario.cup.effective_diameter + scenario.skills.pick.seal_margin;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const PlannedBox box = box_with(random_point(rng, 0.5 * Vector3(0.170, 0.234, 0.094)));
    const Pose X_WP{standing(rng, rng.uniform(-pi, pi)), Vector3(-0.4, -0.3, 0.02)};
    const auto rows = plan_pick(scenario, layout_at(0.3), box, X_WP, X_WP, kTravel, PickKind::First);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_FALSE(rows[0].io.vacuum || rows[1].io.vacuum);
    EXPECT_TRUE(rows[2].io.vacuum) << "it comes on when the tool leaves the face";
    const Pose X_PS = lip_on(X_WP, rows[1].X_WE, cup::pick_length(scenario.cup));
    const Vector3 up_P = X_WP.R.transpose() * Vector3::UnitZ();
    for (int axis = 0; axis < 3; ++axis) {
      const double half = 0.5 * box.size[axis], com = box.inertia.com[axis];
      if (std::abs(up_P[axis]) > 0.5) {
        EXPECT_NEAR(X_PS.p[axis], up_P[axis] * half, 1e-12) << "on the upper face";
      } else {
        const double room = std::max(0.0, half - radius);
        EXPECT_NEAR(X_PS.p[axis], std::clamp(com, -room, room), 1e-12);
      }
    }
    for (const motion::Waypoint& row : rows) {
      EXPECT_NEAR(row.X_WE.R(2, 2), -1.0, 1e-12);
      EXPECT_EQ(row.X_WE.p.head<2>(), rows[1].X_WE.p.head<2>()) << "straight down and up";
    }
    // The box rises until its lower face is at the travel height, held by the cup.
    const double height = -2.0 * lowest_corner(X_WP.R, box.size);
    EXPECT_NEAR(rows[2].X_WE.p.z() - scenario.cup.hold_length - height, kTravel, 1e-12);
  }
}

TEST(PlanPick, ComesFromAsHighAsWhereTheToolIsNeeds) {
  const model::Scenario& scenario = demonstrator();
  const PlannedBox box = box_with(Vector3::Zero());
  for (const double z : {-0.058, 0.3}) {  // low, and higher than what is travelled over
    const Pose X_WP{Matrix3::Identity(), Vector3(-0.4, -0.3, z)};
    CellLayout layout = layout_at(0.0);
    const auto lip = [&](PickKind kind) {
      const auto rows = plan_pick(scenario, layout, box, X_WP, X_WP, kTravel, kind);
      EXPECT_EQ(motion::name_of(rows[1]), kind == PickKind::First ? "Box(BOX027)" : "RePick(BOX027)");
      return rows[0].X_WE.p.z() - scenario.cup.free_length;
    };
    const double top = z + 0.047;
    EXPECT_NEAR(lip(PickKind::First), std::max(kTravel + 0.020, top + 0.060), 1e-12);
    EXPECT_NEAR(lip(PickKind::FromAfar), std::max(kTravel + 0.020, top + 0.060), 1e-12);
    EXPECT_NEAR(lip(PickKind::FromAbove), top + 0.030, 1e-12);
    layout.is_fast = true;
    EXPECT_NEAR(lip(PickKind::First), std::max(kTravel + 0.020, top + 0.035), 1e-12);
  }
}

TEST(PlanPick, SharesTheTurnToTheNextPlaceBetweenBothSidesOfNeutral) {
  Rng rng(42);
  const model::Scenario& scenario = demonstrator();
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    CellLayout layout = layout_at(rng.uniform(-pi, pi));
    layout.is_fast = i % 2 == 1;
    if (layout.is_fast) layout.pan_axis = motion::PanAxis{};
    const PlannedBox box = box_with(Vector3(0.01, -0.02, -0.027));
    const Pose X_WP{standing(rng, rng.uniform(-pi, pi)), random_point(rng, Vector3(0.8, 0.8, 0.1))};
    const double turn = rng.uniform(-pi, pi);
    const Pose X_WP_next{about_vertical(turn) * X_WP.R, random_point(rng, Vector3(0.8, 0.8, 0.1))};
    const auto rows = plan_pick(scenario, layout, box, X_WP, X_WP_next, kTravel, PickKind::First);
    const Pose X_WE = rows[1].X_WE;
    const Pose X_WE_next = make_tool_for(scenario, box, lip_on(X_WP, X_WE, cup::pick_length(scenario.cup)))(X_WP_next);
    const double before = *motion::yaw_of(X_WE.R) - layout.neutral_yaw;
    const double after = *motion::yaw_of(X_WE_next.R) - layout.neutral_yaw;
    // Off its middle the box twists and bends the cup, the same way before and after.
    EXPECT_NEAR(std::remainder(before + after, 2.0 * pi), 0.0, 0.02);
    const double chosen = turn_between(layout, X_WP, X_WP_next);
    EXPECT_NEAR(std::remainder(before + 0.5 * chosen, 2.0 * pi), 0.0, 1e-9);
    EXPECT_NEAR(std::remainder(chosen - turn, 2.0 * pi), 0.0, 1e-9);
  }
}

struct SideScene {
  PlannedBox box = box_with(Vector3(0.02, 0.03, -0.027));
  Pose X_WP;
  Vector3 face;
};

/// Standing on any face, with any side to be picked.
SideScene random_side(Rng& rng) {
  SideScene scene;
  const double yaw = rng.uniform(-pi, pi);
  scene.X_WP.R = standing(rng, yaw);
  scene.X_WP.p = Vector3(-0.45, -0.4, -0.105 - lowest_corner(scene.X_WP.R, scene.box.size));
  scene.face = about_vertical(yaw + 0.5 * pi * rng.index(4)) * Vector3::UnitX();
  return scene;
}

TEST(PlanPick, TakesTheWeightOfTheHeaviestBoxesSlowlyBeforeItLiftsThem) {
  const model::Scenario& scenario = demonstrator();
  CellLayout layout = layout_at(0.3);
  const Pose X_WP{Matrix3::Identity(), Vector3(-0.4, -0.3, 0.02)};
  for (const double mass : {0.5, 4.0, 5.0, 6.0}) {
    SCOPED_TRACE(mass);
    PlannedBox box = box_with(Vector3::Zero());
    box.inertia.mass = mass;
    EXPECT_EQ(may_push_hanging(scenario, box, Vector3::UnitZ()), mass < 4.5);
    layout.is_fast = false;
    EXPECT_EQ(plan_pick(scenario, layout, box, X_WP, X_WP, kTravel, PickKind::First).size(), 3U);
    layout.is_fast = true;
    const auto rows = plan_pick(scenario, layout, box, X_WP, X_WP, kTravel, PickKind::First);
    if (mass < 4.5) {
      EXPECT_EQ(rows.size(), 3U);
      continue;
    }
    ASSERT_EQ(rows.size(), 4U);
    const Vector3 lift = rows[2].X_WE.p - rows[1].X_WE.p;
    EXPECT_NEAR((lift - Vector3(0.0, 0.0, mass * 9.81 / scenario.cup.stiffness.axial)).norm(), 0.0, 1e-9)
        << "as far as the cup gives under it";
    EXPECT_TRUE(rows[2].io.vacuum);
    ASSERT_TRUE(rows[2].swing);
    EXPECT_LT(rows[2].swing->pace, pace_of(scenario, box, Vector3::UnitZ()));
    // Others of its rows get the pace of the way.
    const motion::Swing swing = swing_of(scenario, box, Vector3::UnitZ());
    const auto driven = drivable(layout, rows[0], rows, swing);
    ASSERT_GE(driven.size(), 4U);
    EXPECT_EQ(driven[driven.size() - 2].swing, rows[2].swing);
    EXPECT_EQ(driven.back().swing, motion::as_named(swing));
  }
}

TEST(PlanSidePick, PointsAtTheFaceWithTheLipOffTheGroundAndLittleOverTheUpperEdge) {
  Rng rng(43);
  const model::Scenario& scenario = demonstrator();
  const model::CupParams& cup = scenario.cup;
  const CellLayout layout = layout_at(0.0);
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const SideScene scene = random_side(rng);
    const bool again = i % 2 == 1;
    const auto rows = plan_side_pick(scenario, layout, scene.box, scene.X_WP, scene.face, scene.X_WP, kTravel, again);
    ASSERT_EQ(rows.size(), 5U);
    const Pose X_WE = rows[3].X_WE;
    EXPECT_NEAR(X_WE.R.col(2).dot(scene.face), -std::cos(scenario.skills.side_grasp.incline), 1e-9);
    const Vector3 touched = X_WE.p + (again ? cup.free_length : cup::pick_length(cup)) * X_WE.R.col(2);
    const double breadth = (scene.X_WP.R.transpose() * scene.face).cwiseAbs().dot(scene.box.size);
    EXPECT_NEAR((touched - scene.X_WP.p).dot(scene.face), 0.5 * breadth, 1e-9) << "on that side";
    const double ground = bottom_of(scene.box, scene.X_WP), top = 2.0 * scene.X_WP.p.z() - ground;
    EXPECT_GE(touched.z() - cup.lip_radius, ground + scenario.skills.side_grasp.lip_clearance - 1e-9);
    EXPECT_LE(touched.z() + cup.lip_radius, top + cup.seal.max_overhang + 1e-9);
    // Lifted as it stood, over what is crossed.
    EXPECT_GE(ground + rows[4].X_WE.p.z() - rows[3].X_WE.p.z(), kTravel - 1e-9);
    EXPECT_EQ(rows[4].X_WE.p.head<2>(), rows[3].X_WE.p.head<2>());
    const Pose X_PS = lip_on(scene.X_WP, X_WE, cup.hold_length);
    const auto up = plan_turn_up(scenario, scene.box, scene.X_WP, X_PS, scene.face, kTravel, again);
    EXPECT_TRUE(up.io.vacuum);
    const Pose X_WP_up = hung(scene.box, X_PS, up.X_WE);
    EXPECT_NEAR((X_WP_up.R * scene.X_WP.R.transpose() * scene.face).z(), 1.0, 1e-6) << "that side is up";
    EXPECT_NEAR(bottom_of(scene.box, X_WP_up), kTravel + scenario.skills.side_grasp.turn_clearance, 1e-4);
  }
}

TEST(PlanSidePick, IsNoneWhereTheSideIsTooLowForTheCup) {
  const model::Scenario& scenario = demonstrator();
  const double least = 2.0 * (scenario.cup.lip_radius + scenario.skills.side_grasp.lip_clearance) - 0.015;
  for (const double more : {-1e-6, 1e-6}) {
    PlannedBox box = box_with(Vector3::Zero());
    box.size.z() = least + more;
    const Pose X_WP{Matrix3::Identity(), Vector3(0.0, 0.5, 0.5 * box.size.z())};
    const auto rows = plan_side_pick(scenario, layout_at(0.0), box, X_WP, Vector3::UnitY(), X_WP, kTravel, false);
    EXPECT_EQ(rows.empty(), more < 0.0);
  }
}

TEST(Drivable, NeitherWindsTheWristNorLosesARowOverLongChains) {
  for (const bool is_fast : {false, true}) {
    CellLayout layout = layout_at(0.7);
    layout.is_fast = is_fast;
    layout.pan_axis = motion::PanAxis{};
    const auto way_axis = is_fast ? layout.pan_axis : std::nullopt;
    Rng rng(44);
    motion::Waypoint before = motion::make_waypoint(motion::MotionClass::Home, {},
                                                    {motion::upright_tool(layout.neutral_yaw), Vector3(0.5, 0.0, 0.3)});
    double yaw = 0.0;  // accumulated, from neutral
    for (int i = 0; i < 400; ++i) {
      const double direction = rng.uniform(-pi, pi), radius = rng.uniform(0.15, 0.9);
      const Pose X_WE{motion::upright_tool(rng.uniform(-pi, pi)),
                      Vector3(radius * std::cos(direction), radius * std::sin(direction), rng.uniform(0.1, 0.4))};
      const auto goal = motion::make_waypoint(motion::MotionClass::PrePlace, "A", X_WE, {.vacuum = true});
      const auto rows = drivable(layout, before, {goal});
      ASSERT_FALSE(rows.empty());
      EXPECT_EQ(rows.back(), goal);
      for (const motion::Waypoint& row : rows) {
        const motion::Way way(before.X_WE, row.X_WE, way_axis);
        double last = *motion::yaw_of(way.at(0.0).R);
        for (int part = 1; part <= 16; ++part) {
          const double next = *motion::yaw_of(way.at(part / 16.0).R);
          yaw += std::remainder(next - last, 2.0 * pi);
          last = next;
        }
        before = row;
      }
      ASSERT_LE(std::abs(yaw), pi + 1e-6) << i;
      ASSERT_NEAR(yaw, std::remainder(*motion::yaw_of(X_WE.R) - layout.neutral_yaw, 2.0 * pi), 1e-6) << i;
    }
  }
}

TEST(Drivable, TellsFastMotionsOfTheSwingInRowsInWhichABoxHangs) {
  using motion::MotionClass;
  const motion::Swing swing{0.42, 0.31};
  const Pose X_WE{motion::upright_tool(0.0), Vector3(0.5, 0.0, 0.3)};
  CellLayout layout = layout_at(0.0);
  layout.is_fast = true;
  const motion::Waypoint before = motion::make_waypoint(MotionClass::Home, {}, X_WE);
  const auto swing_in = [&](MotionClass motion_class, bool vacuum) {
    const auto row = motion::make_waypoint(motion_class, "A", {X_WE.R, Vector3(0.6, 0.2, 0.3)}, {.vacuum = vacuum});
    EXPECT_FALSE(drivable(layout, before, {row})[0].swing) << "none is known";
    return drivable(layout, before, {row}, swing)[0].swing;
  };
  for (const MotionClass hangs : {MotionClass::PostPick, MotionClass::PrePlace, MotionClass::PreTwist,
                                  MotionClass::PostRePick, MotionClass::Place}) {
    EXPECT_EQ(swing_in(hangs, true), swing);
    EXPECT_EQ(swing_in(hangs, false), std::nullopt);
  }
  for (const MotionClass pressed :
       {MotionClass::Pick, MotionClass::RePick, MotionClass::Twist, MotionClass::TwistDrag, MotionClass::PlaceSlow}) {
    EXPECT_EQ(swing_in(pressed, true), std::nullopt);
  }
  layout.is_fast = false;
  EXPECT_EQ(swing_in(MotionClass::PrePlace, true), std::nullopt);
  EXPECT_TRUE(drivable(layout, before, {}, swing).empty());
}

TEST(PaceOf, IsTheLargestAtWhichTheCupHoldsAHeavyBox) {
  const model::Scenario& scenario = demonstrator();
  double last = 1.0;
  for (const double mass : {0.5, 1.5, 3.0, 4.0, 5.0, 6.0, 7.0}) {
    PlannedBox box = box_with(Vector3::Zero());
    box.inertia.mass = mass;
    const double pace = pace_of(scenario, box, Vector3::UnitZ());
    EXPECT_LE(pace, last) << mass;
    if (mass <= 3.0) {
      EXPECT_EQ(pace, 1.0) << mass;
    }
    // By hand: tension of lift and stop, slip and peel on the level.
    const double suction = 6.0e4 * std::numbers::pi * 0.03 * 0.03, gravity = scenario.gravity.norm();
    const double radius = scenario.cup.lip_radius, friction = scenario.cup.lip_friction;
    const auto holds = [&](double one) {
      const double level = 5.0 * one * one, depth = 0.5 * box.size.z();
      const double tension = suction / (mass * (gravity + 2.0 * level));
      const double slip = friction * suction / (mass * (level + friction * gravity));
      const double peel = radius * suction / (mass * (level * depth + radius * gravity));
      const double margin = may_push_hanging(scenario, box, Vector3::UnitZ()) ? 1.05 : 1.25;
      return std::min({tension, slip, peel}) >= margin * scenario.place_limits.hold_factor;
    };
    if (pace > 0.25) {
      EXPECT_TRUE(holds(pace)) << mass;
    }
    if (pace < 1.0) {
      EXPECT_FALSE(holds(pace + 0.05)) << mass;
    }
    last = pace;
  }
  EXPECT_LT(last, 0.5);
  PlannedBox box = box_with(Vector3::Zero());
  box.inertia.mass = 1.0;
  const double one = still_hold_factor(scenario, box);
  box.inertia.mass = 8.0;
  EXPECT_NEAR(still_hold_factor(scenario, box), one / 8.0, 1e-9) << "it goes with the weight";
}

TEST(SwingOf, StaysWithinWhatFastMotionsAvoidAndIsSlowerOfAHeavierBox) {
  const model::Scenario& scenario = demonstrator();
  const settings::TravelParams& travel = scenario.skills.travel;
  double last = 0.0;
  for (const double factor : {1e-4, 0.5, 1.0, 1.5, 1e3}) {
    PlannedBox box = box_with(Vector3(0.0, 0.0, -0.027));
    box.inertia.mass *= factor;
    box.inertia.inertia *= factor;
    const motion::Swing swing = swing_of(scenario, box, Vector3::UnitZ());
    EXPECT_GE(swing.slow, swing.fast);
    EXPECT_GE(swing.fast, travel.shortest_swing);
    EXPECT_LE(swing.slow, travel.longest_swing);
    EXPECT_GE(swing.slow, last);
    last = swing.slow;
    EXPECT_EQ(swing.slow == travel.shortest_swing, factor < 1e-3);
  }
  EXPECT_EQ(last, travel.longest_swing);
}

}  // namespace
}  // namespace snug::skills
