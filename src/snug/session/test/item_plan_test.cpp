// ItemPlan: insertions, layouts and grasps on the demonstrator's cell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/model/other_container.hpp"
#include "snug/session/grasp.hpp"
#include "snug/session/surroundings.hpp"

namespace snug::session {
namespace {

model::Scenario demonstrator() { return model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml"); }

/// Every box of sequence 1 in every orientation that needs one turn, in cells that are all a little different: the
/// grasp says how it got there, and the box hangs as asked in nearly all of them.
TEST(PlanGrasp, BringsEveryFaceOfEveryTypeUpInNearlyAllCellsThatCouldBe) {
  const model::Scenario scenario = demonstrator();
  const CellLayout layout = make_layout(scenario);
  const cell::SimulationOptions options{motion::ControllerKind::Faithful, cup::CupMode::Phases, {}};
  std::vector<std::unique_ptr<Rollout>> rollouts;
  std::vector<cell::CellState> states;
  std::vector<double> weights;
  for (int i = 0; i < 5; ++i) {
    const Rng rng = Rng(9).split(std::to_string(i));
    const model::Scenario nominal = cell::with_fixed_arrivals(scenario, "1");
    const model::Scenario drawn = i == 0 ? nominal : cell::draw_scenario(nominal, "1", rng);
    rollouts.push_back(std::make_unique<Rollout>(drawn, "1", options));
    weights.push_back(1.0);
  }
  for (const auto& rollout : rollouts) states.push_back(rollout->state());
  motion::Waypoint from;
  from.X_WE = scenario.controller.X_WE_start;
  from.name = "home";
  const ToolReach everywhere;
  const auto& items = scenario.sequences[0].items;
  double rate = 0.0;
  int grasps = 0;
  for (const char* id : {"BOX013", "BOX017", "BOX027", "BOX023"}) {  // one of each type
    const auto item = std::ranges::find(items, id, &model::Item::parcel);
    ASSERT_NE(item, items.end());
    const PlannedBox box = make_planned_box(scenario, scenario.sequences[0], static_cast<int>(item - items.begin()));
    const Pose X_WP = cell::arrival_pose(rollouts[0]->simulation().scenario(), *item);
    const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * X_WP.R;
    for (int axis = 0; axis < 3; ++axis) {
      packing::Orientation orientation = packing::nearest_orientation(R_AP);
      if (static_cast<int>(orientation.up) == axis) continue;
      orientation.up = static_cast<model::UpAxis>(axis);
      const Grasp grasp = plan_grasp(
          {scenario, layout, rollouts, states, weights, from, box, X_WP, Location::Aligner, 0.0, 1, everywhere},
          orientation);
      SCOPED_TRACE(std::string(id) + " axis " + std::to_string(axis));
      EXPECT_EQ(grasp.problem, GraspProblem::None) << describe(grasp.problem);
      EXPECT_NE(grasp.reorientation, Reorientation::None);
      EXPECT_TRUE(packing::extents(grasp.held_as, box.size).isApprox(packing::extents(orientation, box.size)));
      rollouts[0]->restore(grasp.states[0]);
      const Matrix3 R_WP = rollouts[0]->pose_of(box.item)->R;
      // Hanging, perhaps still swinging: within the 15 degrees that the grasp itself asks of the samples.
      EXPECT_GT(std::abs(R_WP(2, axis)), std::cos(0.26));
      rate += grasp.success_rate;
      ++grasps;
    }
  }
  EXPECT_GE(rate / grasps, 0.9);  // what is asked of items in open-loop runs as a whole
}

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
  for (const Insertion& one : choose_insertions(seen, size)) EXPECT_GE(one.overtravel_T.x(), 0.0);
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
  const auto insertions = choose_insertions(measured(empty, corner, size, 0.0), size);
  ASSERT_EQ(insertions.size(), 1U);
  EXPECT_EQ(insertions[0].skill, InsertionSkill::TopDown);
}

TEST(Layout, HasNoRimWhereThereAreNoWalls) {
  const model::Scenario scenario = demonstrator();
  EXPECT_NEAR(make_layout(scenario).rim, 0.25, 1e-12);
  EXPECT_EQ(make_layout(model::with_pallet(scenario, "600x400x900")).rim, 0.0);
}

TEST(TurnBetween, GoesTheWayRoundOfTheRobotsFirstAxisWhereThatSparesTheWrist) {
  CellLayout layout;
  layout.p_WB = Vector3(0.2, -0.1, 0.0);
  const auto box_at = [&](double direction, double yaw) {
    const Vector3 p_WP = *layout.p_WB + Vector3(std::cos(direction), std::sin(direction), 0.3);
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
  return make_layout(scenario);
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
}  // namespace snug::session
