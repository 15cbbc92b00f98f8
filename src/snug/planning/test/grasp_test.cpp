// Grasps: every face of every box comes up, in the nominal world and in nearly all that could be.
#include "snug/planning/grasp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/planning/test/demonstrator.hpp"

namespace snug::planning {
namespace {

/// Every box of sequence 1 in every orientation that needs one turn, in cells that are all a little different: the
/// grasp says how it got there, and the box hangs as asked in nearly all of them.
class PlanGrasp : public testing::TestWithParam<motion::Tracking> {};

TEST_P(PlanGrasp, BringsEveryFaceOfEveryTypeUpInNearlyAllCellsThatCouldBe) {
  const model::Scenario scenario = demonstrator();
  skills::CellLayout layout = skills::make_layout(scenario, cell::find_pan_axis(scenario));
  layout.is_fast = motion::is_fast(GetParam());
  const cell::SimulationOptions options{GetParam(), cup::CupMode::Phases, {}};
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
  const motion::Waypoint from = motion::make_waypoint(motion::MotionClass::Home, {}, scenario.controller.X_WE_start);
  const ToolReach everywhere;
  const auto& items = scenario.sequences[0].items;
  double rate = 0.0;
  int grasps = 0, outlined = 0;
  for (const char* id : {"BOX013", "BOX017", "BOX027", "BOX023"}) {  // one of each type
    const auto item = std::ranges::find(items, id, &model::Item::parcel);
    ASSERT_NE(item, items.end());
    const skills::PlannedBox box = skills::make_planned_box(scenario, scenario.sequences[0],
                                                            model::ItemIndex(static_cast<int>(item - items.begin())));
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
      const auto outline = outline_grasp(
          {scenario, layout, {}, {}, {}, from, box, X_WP, Location::Aligner, 0.0, 1, everywhere}, orientation);
      ASSERT_TRUE(outline);
      const auto begins = std::ranges::find(grasp.program.waypoints, outline->X_WE.p,
                                            [](const motion::Waypoint& one) { return one.X_WE.p; });
      if (outline->reorientation == grasp.reorientation) {  // else the way that is tried first was not the best
        EXPECT_NE(begins, grasp.program.waypoints.end()) << "there the tool comes to first";
        ++outlined;
      }
      EXPECT_EQ(grasp.problem, GraspProblem::None) << describe(grasp.problem);
      EXPECT_NE(grasp.reorientation, skills::Reorientation::None);
      EXPECT_TRUE(packing::extents(grasp.held_as, box.size).isApprox(packing::extents(orientation, box.size)));
      rollouts[0]->restore(grasp.states[0]);
      const Matrix3 R_EP =
          rollouts[0]->state().controller.command.X_WE.R.transpose() * rollouts[0]->pose_of(box.item)->R;
      // From the cup, by that face, perhaps still swinging: within the 15 degrees that the grasp itself asks of
      // samples. Fast motions turn it up on the way to its place: it may still hang from a level tool, as the cup can
      // bear.
      const double bend = layout.is_fast ? scenario.cup.limits.warn_bend : 0.26;
      EXPECT_GT(std::abs(R_EP(2, axis)), std::cos(bend));
      rate += grasp.success_rate;
      ++grasps;
    }
  }
  EXPECT_GT(2 * outlined, grasps);
  EXPECT_GE(rate / grasps, 0.9);  // what is asked of items in open-loop runs as a whole
}

INSTANTIATE_TEST_SUITE_P(Controllers, PlanGrasp,
                         testing::Values(motion::Tracking(motion::LaggedTracking{}),
                                         motion::Tracking(motion::FastTracking{})));

}  // namespace
}  // namespace snug::planning
