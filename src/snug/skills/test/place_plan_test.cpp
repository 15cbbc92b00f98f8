// Plans of places, presses and turns: where the hanging box really is at each row, whichever way the scene is turned.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/way.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/skills/item_plan.hpp"
#include "snug/skills/test/scene.hpp"

namespace snug::skills {
namespace {

using std::numbers::pi;

constexpr double kSettled = 1e-4;  ///< m and rad: what the rounds of the tool's sag leave, less than 0.01 degrees

/// The container turned, a box in it, the cup off the middle of the face.
struct PlaceScene {
  CellLayout layout = make_layout(demonstrator(), std::nullopt);
  PlaceRequest request;
  explicit PlaceScene(double yaw = 0.7) {
    layout.X_WT.R = about_vertical(yaw);
    request.box = box_with(Vector3(0.03, 0.02, -0.027));
    request.X_PS = {exp_rotation(Vector3(0.0, pi, 0.0)), Vector3(0.02, -0.01, 0.047)};
    request.X_TP = {about_vertical(0.5 * pi), Vector3(0.03, 0.1, 0.20)};
    request.packed_top = 0.3;
  }
  [[nodiscard]] Pose rest() const { return layout.X_WT * request.X_TP; }
  [[nodiscard]] std::vector<motion::Waypoint> rows() const { return plan_place(demonstrator(), layout, request); }
  /// The box at a row, seen from where it shall rest, in T.
  [[nodiscard]] Pose off(const motion::Waypoint& row) const {
    const Pose X_WP = hung(request.box, request.X_PS, row.X_WE);
    const Matrix3 R_TW = layout.X_WT.R.transpose();
    return {R_TW * X_WP.R * rest().R.transpose() * layout.X_WT.R, R_TW * (X_WP.p - rest().p)};
  }
};

void expect_at(const Pose& off, const Vector3& p) {
  EXPECT_LT((off.p - p).norm(), kSettled) << off.p.transpose() << " and not " << p.transpose();
  EXPECT_LT(angle_between(off.R, Matrix3::Identity()), 2.0 * kSettled);
}

std::string variants_of(const std::vector<motion::Waypoint>& rows) {
  std::string names;
  for (const motion::Waypoint& row : rows) {
    names += std::string(motion::name_of(row.motion_class)) + row.variant + (row.io.vacuum ? "+ " : " ");
  }
  return names;
}

TEST(MakeToolFor, RaisesTheToolByWhatTheCupGivesAndLeavesTheBoxWhereItShallBe) {
  const model::Scenario& scenario = demonstrator();
  const PlannedBox centred = box_with(Vector3(0.0, 0.0, -0.027));
  const Pose X_PS{exp_rotation(Vector3(0.0, pi, 0.0)), Vector3(0.0, 0.0, 0.047)};
  const Pose X_WE = make_tool_for(scenario, centred, X_PS)(Pose{});
  const double sag = centred.inertia.mass * 9.81 / scenario.cup.stiffness.axial;
  EXPECT_LT((X_WE.p - Vector3(0.0, 0.0, 0.047 + scenario.cup.hold_length + sag)).norm(), 1e-6);
  Rng rng(51);
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const PlannedBox box = box_with(Vector3(rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), -0.027));
    const Pose X_PS_i{exp_rotation(Vector3(0.0, pi, 0.0)) * about_vertical(rng.uniform(-pi, pi)),
                      Vector3(rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), 0.047)};
    // Also lying in the air, the cup at its side.
    const Pose X_WP{exp_rotation(Vector3(rng.uniform(0.0, 0.5 * pi), 0.0, rng.uniform(-1.0, 1.0))),
                    Vector3(0.3, -0.2, 0.4)};
    const Pose X_WP_hung = hung(box, X_PS_i, make_tool_for(scenario, box, X_PS_i)(X_WP));
    EXPECT_LT((X_WP_hung.p - X_WP.p).norm(), kSettled);
    EXPECT_LT(angle_between(X_WP_hung.R, X_WP.R), 2.0 * kSettled);
  }
}

TEST(PlanPlace, LowersTheBoxStraightDownToItsPlace) {
  const PlaceScene scene;
  const auto rows = scene.rows();
  ASSERT_EQ(variants_of(rows), "PrePlace+ PrePlace_2+ Place+ Place PostPlace ");
  const double rest = bottom_of(scene.request.box, scene.rest());
  expect_at(scene.off(rows[0]), Vector3(0.0, 0.0, travel_bottom(scene.layout, 0.3) - rest));
  expect_at(scene.off(rows[1]), Vector3(0.0, 0.0, scene.layout.X_WT.p.z() + 0.3 + 0.010 - rest));
  expect_at(scene.off(rows[2]), Vector3(0.0, 0.0, -0.005));
  EXPECT_EQ(rows[2].X_WE, rows[3].X_WE);
  EXPECT_TRUE(rows[3].io.blow_off);
  EXPECT_EQ(rows[4].X_WE.p.head<2>(), rows[3].X_WE.p.head<2>());
  EXPECT_GT(rows[4].X_WE.p.z() - demonstrator().cup.free_length, scene.layout.X_WT.p.z() + 0.3);
}

TEST(PlanPlace, SlidesAlongTheAxesOfTheContainerAndSlowlyWhereItIsGentle) {
  PlaceScene scene;
  scene.request.insertion = {.skill = InsertionSkill::SlideToContact,
                             .come_from_T = Vector3(0.01, -0.008, 0.0),
                             .overtravel_T = Vector3(-0.005, 0.005, 0.0)};
  const auto rows = scene.rows();
  ASSERT_EQ(variants_of(rows), "PrePlace+ PrePlace_2+ Place_down+ PlaceSlow_push+ Place+ Place PostPlace ");
  expect_at(scene.off(rows[2]), Vector3(0.01, -0.008, 0.003));
  expect_at(scene.off(rows[3]), Vector3(-0.005, 0.005, 0.003));
  expect_at(scene.off(rows[4]), Vector3(-0.0025, 0.0025, -0.005));
  for (const std::size_t i : {0U, 1U}) EXPECT_LT((scene.off(rows[i]).p - scene.off(rows[2]).p).head<2>().norm(), 1e-5);
  scene.request.insertion.gentle = true;
  const auto gentle = scene.rows();
  ASSERT_EQ(variants_of(gentle),
            "PrePlace+ PrePlace_2+ PlaceSlow_down+ PlaceSlow_push+ PlaceSlow+ PlaceSlow PostPlace ");
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(gentle[i].X_WE, rows[i].X_WE);
}

/// In fast motions the tool leans into a push, about its lip: the force of a neighbour acts below the cup.
TEST(PlanPlace, LeansIntoAPushSoThatTheLowerEdgeGoesAheadAsFarAsTheForceAsks) {
  PlaceScene scene;
  scene.request.insertion = {.skill = InsertionSkill::SlideToContact, .come_from_T = Vector3(0.01, -0.01, 0.0)};
  const model::CupParams& cup = demonstrator().cup;
  const double height = (scene.request.X_TP.R.row(2).cwiseAbs() * scene.request.box.size).value();
  for (const Vector3& push : {Vector3(-0.0005, 0.0, 0.0), Vector3(-0.0002, 0.0003, 0.0), Vector3(-0.005, 0.005, 0.0)}) {
    SCOPED_TRACE(push.transpose());
    scene.request.insertion.overtravel_T = push;
    scene.layout.is_fast = false;
    const auto upright = scene.rows();
    scene.layout.is_fast = true;
    const auto rows = scene.rows();
    ASSERT_EQ(variants_of(rows), "PrePlace+ Place_down+ PlaceSlow_push+ Place+ Place PostPlace ");
    EXPECT_LT(angle_between(rows[1].X_WE.R, upright[2].X_WE.R), 1e-9) << "it goes down upright";
    const double asked = 0.2 * height * cup.stiffness.lateral * push.norm() / cup.stiffness.bend;
    for (std::size_t i = 2; i < 5; ++i) {
      const Matrix3 lean_T =
          scene.layout.X_WT.R.transpose() * rows[i].X_WE.R * upright[i + 1].X_WE.R.transpose() * scene.layout.X_WT.R;
      EXPECT_NEAR(angle_between(lean_T, Matrix3::Identity()), std::min(asked, 0.09), 1e-9);
      EXPECT_GT((lean_T * -Vector3::UnitZ()).dot(push.normalized()), 0.9 * std::min(asked, 0.09)) << "what is below";
      const Vector3 p_ELip(0.0, 0.0, cup.hold_length);
      EXPECT_LT((rows[i].X_WE * p_ELip - upright[i + 1].X_WE * p_ELip).norm(), 1e-9) << "about the lip";
    }
  }
}

TEST(PlanPlace, OnItsSupportItPushesTheBoxWithTheCupUnloadedAndLetsGoOverItsPlace) {
  PlaceScene scene;
  scene.request.insertion = {.skill = InsertionSkill::SlideOnSupport,
                             .come_from_T = Vector3(0.01, 0.0, 0.0),
                             .overtravel_T = Vector3(-0.005, 0.0, 0.0)};
  const auto rows = scene.rows();
  ASSERT_EQ(variants_of(rows), "PrePlace+ PrePlace_2+ Place_down+ PlaceSlow_push+ Place+ Place PostPlace ");
  // Lower than where the box hangs on its place by the sag of the cup, and by the press: all of the weight is below.
  const model::CupParams& cup = demonstrator().cup;
  const double lowered = scene.request.box.inertia.mass * 9.81 / cup.stiffness.axial + 0.005;
  const double lead = 25.0 / cup.stiffness.lateral;  // what ends the push, N
  expect_at(scene.off(rows[2]), Vector3(0.01, 0.0, -lowered));
  expect_at(scene.off(rows[3]), Vector3(-0.005 - lead, 0.0, -lowered));
  expect_at(scene.off(rows[4]), Vector3(0.0, 0.0, -lowered));
  EXPECT_EQ(rows[4].X_WE, rows[5].X_WE);
}

TEST(PlanPlace, TiltsTheLowSideIntoTheSlotFirstAndLevelsItThere) {
  for (const Vector3& low_side : {Vector3(1.0, 0.0, 0.0), Vector3(0.0, 1.0, 0.0), Vector3(-1.0, 0.0, 0.0)}) {
    PlaceScene scene(0.5 * pi);
    const double edge = scene.request.X_TP.p.z() + 0.02;
    scene.request.insertion = {.skill = InsertionSkill::Tilted,
                               .come_from_T = 0.004 * low_side,
                               .low_side_T = low_side,
                               .push_T = -0.004 * low_side,
                               .edge_height_T = edge};
    const auto rows = scene.rows();
    ASSERT_EQ(variants_of(rows), "PrePlace+ PrePlace_2+ Place_tilted+ Place_in+ Place_level+ Place+ Place PostPlace ");
    const double heights[] = {0.012, 0.006, -0.015};
    const Vector3 half = 0.5 * (scene.request.X_TP.R.cwiseAbs() * scene.request.box.size);
    for (std::size_t i = 1; i < 4; ++i) {
      const Pose X_WP = hung(scene.request.box, scene.request.X_PS, rows[i].X_WE);
      EXPECT_NEAR(bottom_of(scene.request.box, X_WP), scene.layout.X_WT.p.z() + edge + heights[i - 1], 2.0 * kSettled);
      const Pose off = scene.off(rows[i]);
      EXPECT_NEAR(angle_between(off.R, Matrix3::Identity()), demonstrator().skills.insertion.tilted.angle,
                  2.0 * kSettled);
      EXPECT_LT((off.R * low_side).z(), -0.1) << "that side is the low one";
      // The lower edge that leads is where it will be when the box is level, and by the push beyond.
      const Vector3 corner = half.dot(low_side.cwiseAbs()) * low_side - half.z() * Vector3::UnitZ();
      const Vector3 ahead = off.p + off.R * corner - corner;
      EXPECT_NEAR(ahead.dot(low_side), i == 1 ? 0.004 : -0.004, 2.0 * kSettled);
    }
    const double level = edge - 0.015 - (scene.request.X_TP.p.z() - half.z());
    expect_at(scene.off(rows[4]), -0.004 * low_side + level * Vector3::UnitZ());
    expect_at(scene.off(rows[5]), -0.002 * low_side - 0.005 * Vector3::UnitZ());
  }
}

TEST(PlanPlace, PassesOverEverythingFromASidePickAndComesStraightDownWhereMotionsAreFast) {
  Rng rng(52);
  const model::Scenario& scenario = demonstrator();
  int raised = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    PlaceScene scene;
    scene.layout.is_fast = true;
    scene.layout.pan_axis = motion::PanAxis{};
    const double yaw = rng.uniform(-pi, pi), travel = travel_bottom(scene.layout, scene.request.packed_top);
    const PlannedBox& box = scene.request.box;
    Pose X_WP{standing(rng, yaw), Vector3(-0.45, -0.4, 0.0)};
    X_WP.p.z() = -0.105 - lowest_corner(X_WP.R, box.size);
    const Vector3 face = about_vertical(yaw + 0.5 * pi * rng.index(4)) * Vector3::UnitX();
    const Matrix3 R_TW = scene.layout.X_WT.R.transpose();
    scene.request.X_TP.R = R_TW * about_vertical(rng.uniform(-pi, pi)) * face_up(X_WP.R, face);
    const auto picked = plan_side_pick(scenario, scene.layout, box, X_WP, face, scene.rest(), travel, i % 2 == 0);
    ASSERT_EQ(picked.size(), 5U);
    scene.request.X_WE = picked[4].X_WE;
    scene.request.X_EP = picked[3].X_WE.inverse() * X_WP;
    scene.request.X_PS = lip_on(X_WP, picked[3].X_WE, scenario.cup.hold_length);
    const auto rows = scene.rows();
    ASSERT_EQ(variants_of(rows), "PrePlace+ Place+ Place PostPlace ");
    // Where its own cup lets it, as it was pressed: within what 25 looks at the way leave.
    const motion::Way way(picked[4].X_WE, rows[0].X_WE, scene.layout.pan_axis);
    double lowest = 1.0;
    for (int part = 0; part <= 100; ++part) {
      lowest = std::min(lowest, bottom_of(box, way.at(part / 100.0) * scene.request.X_EP));
    }
    EXPECT_GT(lowest, travel - scenario.skills.travel.clearance + scenario.skills.travel.turning_clearance - 0.003);
    raised += scene.off(rows[0]).p.z() + bottom_of(box, scene.rest()) > travel + 0.001 ? 1 : 0;
    EXPECT_LT((rows[0].X_WE.p - rows[1].X_WE.p).head<2>().norm(), 1e-9) << "straight down";
    expect_at(scene.off(rows[1]), Vector3(0.0, 0.0, -0.005));
  }
  RecordProperty("raised", std::to_string(raised));
}

TEST(PlanPress, PushesOnTheMiddleFromAboveWithoutVacuum) {
  const model::Scenario& scenario = demonstrator();
  const CellLayout layout = make_layout(scenario, std::nullopt);
  const PlannedBox box = box_with(Vector3::Zero());
  for (const double travel : {0.1, 0.9}) {
    const Pose X_WP{exp_rotation(Vector3(0.1, 0.05, 0.3)), Vector3(0.5, -0.3, 0.4)};
    const auto rows = plan_press(scenario, layout, box, X_WP, travel);
    ASSERT_EQ(variants_of(rows), "PrePlace_press PlaceSlow_press PostPlace_press ");
    const double top = 2.0 * X_WP.p.z() - bottom_of(box, X_WP), lip = scenario.cup.free_length;
    EXPECT_NEAR(rows[1].X_WE.p.z() - lip, top - 0.030, 1e-12);
    EXPECT_NEAR(rows[0].X_WE.p.z() - lip, std::max(travel, top) + 0.020, 1e-12);
    EXPECT_EQ(rows[0].X_WE.p, rows[2].X_WE.p);
    for (const auto& row : rows) {
      EXPECT_EQ(row.X_WE.p.head<2>(), X_WP.p.head<2>());
      EXPECT_NEAR(row.X_WE.R(2, 2), -1.0, 1e-12);
    }
  }
}

TEST(PlanFlip, BringsTheAxisAskedForUpAndTheBoxOntoThePlace) {
  Rng rng(53);
  const model::Scenario& scenario = demonstrator();
  const settings::PivotParams& params = scenario.skills.pivot;
  const PlannedBox box = box_with(Vector3(0.0, 0.0, -0.01));
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const double heading = rng.uniform(-pi, pi), yaw = rng.uniform(-pi, pi);
    const FlipPlace place{Vector3(0.1, -0.2, 0.03), about_vertical(heading) * Vector3::UnitX()};
    const Matrix3 R_before = standing(rng, yaw);
    const Vector3 up_P = R_before.transpose() * about_vertical(yaw + 0.5 * pi * rng.index(4)) * Vector3::UnitX();
    const Matrix3 R_WP = orientation_before_flip(R_before, up_P, place.direction);
    EXPECT_TRUE((R_WP * R_before.transpose()).col(2).isApprox(Vector3::UnitZ(), 1e-9)) << "about the vertical alone";
    const Matrix3 R_after = flipped(R_WP, place.direction);
    EXPECT_NEAR((R_after * up_P).z(), 1.0, 1e-9);
    const Vector3 top_P = R_WP.transpose() * Vector3::UnitZ();
    const Pose X_PS{R_WP.transpose() * motion::upright_tool(heading), 0.5 * box.size.cwiseProduct(top_P)};
    const auto rows = plan_flip(scenario, box, place, R_WP, X_PS, 0.2);
    ASSERT_EQ(rows.size(), 7U);
    EXPECT_NEAR(bottom_of(box, hung(box, X_PS, rows[0].X_WE)), 0.2, kSettled);
    // At the end the surface carries it, so that the cup is not bent.
    const Pose X_WP = rows[3].X_WE * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.050)} * X_PS.inverse();
    EXPECT_LT(angle_between(X_WP.R, R_after), 1e-5);
    EXPECT_NEAR(bottom_of(box, X_WP), place.p_WF.z() - params.press, 1e-5);
    EXPECT_LT((X_WP.p - params.dragged * place.direction - place.p_WF).head<2>().norm(), 1e-5);
    EXPECT_GT(rows[3].X_WE.R.col(2).dot(place.direction), 1.0 - 1e-6) << "the tool points there";
    // Set down as it hangs, its middle over the place.
    const auto down = plan_set_down(scenario, box, place, R_WP, X_PS, 0.2);
    ASSERT_EQ(variants_of(down), "PreTwist+ PreTwist_low+ Twist+ Twist PreTwist_back ");
    const double heights[] = {0.2, place.p_WF.z() + 0.010, place.p_WF.z() - 0.003};
    for (std::size_t k = 0; k < 3; ++k) {
      const Pose X_WP_k = hung(box, X_PS, down[k].X_WE);
      EXPECT_NEAR(bottom_of(box, X_WP_k), heights[k], kSettled);
      EXPECT_LT((X_WP_k.p - place.p_WF).head<2>().norm(), kSettled);
    }
  }
}

/// What is planned in a scene that is turned about the vertical and shifted.
std::vector<motion::Waypoint> everything(const Pose& X_VW, bool is_fast) {
  const model::Scenario& scenario = demonstrator();
  PlaceScene scene;
  const double turn = std::atan2(X_VW.R(1, 0), X_VW.R(0, 0));
  scene.layout.is_fast = is_fast;
  scene.layout.X_WT = X_VW * scene.layout.X_WT;
  scene.layout.pan_axis = motion::PanAxis{X_VW.p};
  scene.layout.neutral_yaw += turn;
  const PlannedBox& box = scene.request.box;
  const Pose X_WP = X_VW * Pose{about_vertical(2.2), Vector3(-0.45, -0.4, -0.058)};
  const Vector3 face = X_VW.R * about_vertical(2.2) * Vector3::UnitY();
  const FlipPlace place{X_VW * Vector3(0.0, -0.5, 0.0), X_VW.R * Vector3::UnitX()};
  std::vector<motion::Waypoint> all;
  const auto add = [&](const std::vector<motion::Waypoint>& rows) { all.insert(all.end(), rows.begin(), rows.end()); };
  const Pose X_WP_lean = X_VW * Pose{exp_rotation(Vector3(0.1, 0.05, 0.3)), Vector3(0.5, -0.3, 0.0)};
  add(plan_pick(scenario, scene.layout, box, X_WP, scene.rest(), 0.2, PickKind::First));
  scene.request.X_WE = all.back().X_WE;
  scene.request.X_PS = lip_on(X_WP, all[1].X_WE, cup::pick_length(scenario.cup));
  scene.request.X_EP = all[1].X_WE.inverse() * X_WP;
  scene.request.insertion.come_from_T = Vector3(0.01, 0.0, 0.0);
  scene.request.insertion.overtravel_T = Vector3(-0.005, 0.0, 0.0);
  add(scene.rows());
  scene.request.insertion.skill = InsertionSkill::Tilted;
  scene.request.insertion.low_side_T = Vector3::UnitY();
  scene.request.insertion.edge_height_T = 0.2;
  add(scene.rows());
  add(plan_side_pick(scenario, scene.layout, box, X_WP, face, scene.rest(), 0.2, false));
  const Pose X_PS_side = lip_on(X_WP, all[all.size() - 2].X_WE, cup::pick_length(scenario.cup));
  all.push_back(plan_turn_up(scenario, box, X_WP, X_PS_side, face, 0.2, false));
  add(plan_leaning_pick(scenario, scene.layout, box, X_WP_lean, scene.rest(), 0.2));
  add(plan_press(scenario, scene.layout, box, X_WP_lean, 0.2));
  add(plan_set_down(scenario, box, place, X_WP.R, scene.request.X_PS, 0.2));
  add(plan_flip(scenario, box, place, orientation_before_flip(X_WP.R, Vector3::UnitY(), place.direction),
                scene.request.X_PS, 0.2));
  return all;
}

TEST(Plans, TurnAndShiftWithTheWholeScene) {
  for (const bool is_fast : {false, true}) {
    for (const double turn : {-2.9, -0.5 * pi, 0.4, 0.5 * pi, 1.7, pi}) {
      SCOPED_TRACE(turn);
      const Pose X_VW{about_vertical(turn), Vector3(0.7, -1.3, 0.0)};
      const auto before = everything(Pose{}, is_fast), after = everything(X_VW, is_fast);
      ASSERT_EQ(after.size(), before.size());
      for (std::size_t i = 0; i < before.size(); ++i) {
        SCOPED_TRACE(motion::name_of(before[i]));
        const Pose X_VE = X_VW * before[i].X_WE;
        EXPECT_LT((after[i].X_WE.p - X_VE.p).norm(), 1e-7);  // what the search for the sag stops at
        EXPECT_LT(angle_between(after[i].X_WE.R, X_VE.R), 1e-6);
        EXPECT_EQ(motion::name_of(after[i]), motion::name_of(before[i]));
        EXPECT_EQ(after[i].io, before[i].io);
      }
    }
  }
}

}  // namespace
}  // namespace snug::skills
