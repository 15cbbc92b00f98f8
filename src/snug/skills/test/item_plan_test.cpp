// ItemPlan: insertions and layouts on the demonstrator's cell; what is around a place.
#include "snug/skills/item_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/model/other_container.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/surroundings.hpp"
#include "snug/skills/test/demonstrator.hpp"

namespace snug::skills {
namespace {

/// A cube of 0.1 m, 5 mm beside one that stands against the wall at low x.
packing::Candidate seen_beside_a_cube(bool has_walls) {
  packing::ContainerState state;
  state.has_walls = has_walls;
  packing::PlacedBox box;
  box.item.size = Vector3(0.1, 0.1, 0.1);
  box.X_TP.p = Vector3(-0.135, 0.0, 0.05);
  state.boxes.push_back(box);
  packing::Candidate candidate;
  candidate.placement.X_TP.p = Vector3(-0.030, 0.0, 0.06);
  return measured(state, candidate, box.item.size, 0.0);
}

TEST(Measured, SeesWallsAndNeighboursAndStandsOnWhatCarries) {
  const packing::Candidate seen = seen_beside_a_cube(true);
  EXPECT_NEAR(seen.placement.X_TP.p.z(), 0.05, 1e-12);
  EXPECT_NEAR(seen.side_gap[0], 0.005, 1e-12);
  EXPECT_NEAR(seen.side_height[0], 0.1, 1e-12);
  EXPECT_NEAR(seen.side_gap[1], 0.5 * packing::ContainerState{}.inner_size.x() - 0.02, 1e-12);
}

TEST(Measured, SeesAnObstacleBesideAndIsNotPushedAgainstIt) {
  packing::ContainerState state;
  state.obstacles = {{Vector3(-0.1, -0.1, 0.0), Vector3(0.0, 0.1, 0.09)}};
  packing::Candidate candidate;
  const Vector3 size = Vector3::Constant(0.1);
  candidate.placement.X_TP.p = Vector3(0.0615, 0.0, 0.05);  // at the 12 mm that are kept, less an interference
  const packing::Candidate seen = measured(state, candidate, size, 0.0);
  EXPECT_NEAR(seen.side_gap[0], 0.0115, 1e-12);
  EXPECT_NEAR(seen.side_height[0], 0.09, 1e-12);
  EXPECT_NEAR(seen.placement.X_TP.p.z(), 0.05, 1e-12) << "it carries nothing";
  for (const Insertion& one : choose_insertions(seen, size, {})) EXPECT_GE(one.overtravel_T.x(), 0.0);
}

TEST(Measured, SeesNothingBesideTheEdgeOfAPallet) {
  const packing::Candidate seen = seen_beside_a_cube(false);
  EXPECT_NEAR(seen.side_gap[0], 0.005, 1e-12);
  EXPECT_NEAR(seen.side_height[0], 0.1, 1e-12);
  for (const std::size_t side : {1U, 2U, 3U}) {
    EXPECT_GT(seen.side_gap[side], 0.5) << side;
    EXPECT_EQ(seen.side_height[side], 0.0) << side;
  }
  // At the corner of the slab nothing is there to slide against, and a way is free.
  packing::ContainerState empty;
  empty.has_walls = false;
  packing::Candidate corner;
  corner.placement.X_TP.p = Vector3(-0.135, -0.235, 0.05);
  const Vector3 size = Vector3::Constant(0.1);
  const auto insertions = choose_insertions(measured(empty, corner, size, 0.0), size, {});
  ASSERT_EQ(insertions.size(), 1U);
  EXPECT_EQ(insertions[0].skill, InsertionSkill::TopDown);
}

TEST(Layout, HasNoRimWhereThereAreNoWalls) {
  const model::Scenario scenario = demonstrator();
  EXPECT_NEAR(make_layout(scenario, std::nullopt).rim, 0.25, 1e-12);
  EXPECT_EQ(make_layout(model::with_pallet(scenario, "600x400x900"), std::nullopt).rim, 0.0);
}

TEST(TurnBetween, GoesTheWayRoundOfTheRobotsFirstAxisWhereThatSparesTheWrist) {
  CellLayout layout;
  layout.pan_axis = motion::PanAxis{Vector3(0.2, -0.1, 0.0)};
  const auto box_at = [&](double direction, double yaw) {
    const Vector3 p_WP = layout.pan_axis->p_WB + Vector3(std::cos(direction), std::sin(direction), 0.3);
    return Pose{exp_rotation(Vector3(0.0, 0.0, yaw)), p_WP};
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (const double pan : {-1.7, 0.0, 1.7}) {
    for (double turn = -3.1; turn < 3.1; turn += 0.2) {
      layout.is_fast = false;
      const Pose from = box_at(0.3, -0.4), to = box_at(0.3 + pan, -0.4 + turn);
      EXPECT_NEAR(turn_between(layout, from, to), turn, 1e-9) << "the shorter way";
      layout.is_fast = true;
      const double chosen = turn_between(layout, from, to);
      EXPECT_NEAR(std::remainder(chosen - turn, kTurn), 0.0, 1e-9);
      EXPECT_LE(std::abs(pan - chosen), std::abs(pan - turn) + 1e-9);
      EXPECT_LE(std::abs(chosen), 0.75 * kTurn + 1e-9);
    }
  }
  EXPECT_NEAR(turn_between(layout, box_at(0.0, 0.0), box_at(1.7, -2.27)), kTurn - 2.27, 1e-9);
}

TEST(WithDetaching, LeavesABoxAlongTheToolUntilTheFreeCupIsOffIt) {
  const model::Scenario& scenario = demonstrator();
  const CellLayout layout = make_layout(scenario, std::nullopt);
  const Pose X_WE{motion::upright_tool(0.4), Vector3(0.2, -0.3, 0.15)};
  const auto rows = [&](motion::MotionClass place, motion::MotionClass after) {
    return std::vector<motion::Waypoint>{motion::make_waypoint(place, "A", X_WE, {.vacuum = true}),
                                         motion::make_waypoint(place, "A", X_WE, {.blow_off = true}),
                                         motion::make_waypoint(after, "A", {X_WE.R, X_WE.p + Vector3(0.0, 0.0, 0.2)})};
  };
  const auto placed = with_detaching(layout, rows(motion::MotionClass::Place, motion::MotionClass::PostPlace));
  ASSERT_EQ(placed.size(), 4U);
  const double growth = scenario.cup.free_length - scenario.cup.hold_length;
  EXPECT_NEAR((placed[2].X_WE.p - X_WE.p - Vector3(0.0, 0.0, growth + 0.003)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(placed[2].io.blow_off);
  EXPECT_EQ(placed[2].motion_class, motion::MotionClass::PostPlace);
  const auto dragged = rows(motion::MotionClass::TwistDrag, motion::MotionClass::PreTwist);
  EXPECT_EQ(with_detaching(layout, dragged), dragged) << "it is let go on the way";
}

/// A cell with one bench of 0.5 x 0.7 m over the aligner, the container twice `way` from there.
CellLayout layout_with_bench(const Vector3& way) {
  model::Scenario scenario = demonstrator();
  model::Body bench;
  bench.name = "bench";
  bench.kind = model::BodyKind::Static;
  bench.shapes.push_back({geometry::Box{Vector3(0.25, 0.35, 0.05)}, Pose{}});
  bench.X_WB.p = Vector3(1.0, 2.0, 0.0);
  scenario.bodies = {bench};
  scenario.aligner->X_WA.p = Vector3(1.0, 2.0, -1.0);
  scenario.containers[0].X_WT.p = Vector3(1.0, 2.0, -1.0) + 2.0 * way;
  return make_layout(scenario, std::nullopt);
}

TEST(Layout, KeepsRoomForAFlipWhereTheBoxComesDownAndNowhereElse) {
  for (const Vector3& way :
       {Vector3(0.9, 0.1, 0.0), Vector3(-0.9, 0.1, 0.0), Vector3(0.1, 0.9, 0.0), Vector3(0.1, -0.9, 0.0)}) {
    const CellLayout layout = layout_with_bench(way);
    ASSERT_TRUE(layout.flip_place.has_value());
    int axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    const double sign = way[axis] > 0.0 ? 1.0 : -1.0;
    EXPECT_EQ(layout.flip_place->direction, Vector3(sign * Vector3::Unit(axis)));
    // Pulled as far toward the container as the room lets it: 160 mm and 80 mm more from that edge; 160 mm across.
    const double half[2] = {0.25, 0.35}, middle[2] = {1.0, 2.0};
    EXPECT_NEAR(sign * (layout.flip_place->p_WF[axis] - middle[axis]), half[axis] - 0.24, 1e-12);
    EXPECT_NEAR(layout.flip_place->p_WF[1 - axis] - middle[1 - axis], std::min(0.1, half[1 - axis] - 0.16), 1e-12);
  }
}

}  // namespace
}  // namespace snug::skills
