// Places of base and aligner: found where they are known, reached pose by pose, written into the text, refused by name.
#include "snug/runs/cell_place.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/pose_edit.hpp"
#include "snug/runs/internal/reach_profile.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::runs {
namespace {

const std::string kCell = SNUG_SOURCE_DIR "/scenarios/init/ur.yaml";

model::Scenario ur_cell() { return model::load_scenario(kCell); }

PlaceOptions with_plinth() {
  PlaceOptions options;
  options.stand_with_robot = {"plinth"};
  options.threads = 2;
  return options;
}

/// Whether a map of the cell, asked pose by pose, is reached at every pick and nearly everywhere over the container:
/// its outermost points are nearer to the walls than boxes are put.
void expect_reached(const model::Scenario& scenario) {
  const ReachMap map = make_reach_map(scenario, 2);
  for (const ReachPick& pick : map.picks) EXPECT_EQ(pick.point.verdict, ReachVerdict::Reached) << pick.item;
  const ReachLayer& carried = map.layers.back();
  EXPECT_EQ(std::ranges::count(carried.points, ReachVerdict::Reached, &ReachPoint::verdict),
            static_cast<std::ptrdiff_t>(carried.points.size()));
}

TEST(CellPlace, FindsAPlaceForACellThatIsPulledApart) {
  model::Scenario scenario = ur_cell();
  scenario.source_text = model::move_parts(
      scenario, std::vector<model::PoseEdit>{{"robot", {-0.9, 1.1, 0.0}, 0.3}, {"aligner", {0.35, -0.6, -0.2}, 0.0}});
  scenario = model::parse_scenario(scenario.source_text, kCell);
  const PlaceSearch search = place_cell(scenario, with_plinth());
  EXPECT_LT(search.before.reached, search.asked);
  ASSERT_FALSE(search.places.empty());
  const PlacedCell& best = search.places.front();
  EXPECT_EQ(best.reached, search.asked) << best.missing;
  EXPECT_EQ(best.missing, "");
  EXPECT_GT(best.margin, 0.0);
  const std::string text = write_place(scenario, best, with_plinth());
  const model::Scenario placed = model::parse_scenario(text, kCell);
  EXPECT_LT((placed.robot->X_WB.p - best.X_WB.p).norm(), 2e-6);
  EXPECT_LT((placed.aligner->X_WA.p - best.X_WA.p).norm(), 2e-6);
  EXPECT_LT((placed.controller.X_WE_start.p - best.X_WE_start.p).norm(), 2e-6);
  ASSERT_EQ(placed.robot->posture.size(), best.posture.size());
  for (std::size_t i = 0; i < best.posture.size(); ++i) EXPECT_NEAR(placed.robot->posture[i], best.posture[i], 1e-4);
  EXPECT_NE(text.find("# What is packed into"), std::string::npos) << "comments stay";
  expect_reached(placed);
  // The plinth keeps its place under the base.
  const auto plinth = [](const model::Scenario& one) {
    return one.robot->X_WB.inverse() * std::ranges::find(one.bodies, "plinth", &model::Body::name)->X_WB;
  };
  EXPECT_LT((plinth(placed).p - plinth(scenario).p).norm(), 1e-5);
}

TEST(CellPlace, DoesNotDependOnThreadsAndKeepsWhatItIsTold) {
  const model::Scenario scenario = ur_cell();
  PlaceOptions options = with_plinth();
  options.moves_height = false;
  const PlaceSearch two = place_cell(scenario, options);
  options.threads = 1;
  EXPECT_EQ(format_json(two), format_json(place_cell(scenario, options)));
  ASSERT_FALSE(two.places.empty());
  for (const PlacedCell& place : two.places) EXPECT_EQ(place.X_WB.p.z(), scenario.robot->X_WB.p.z());
  options.moves_robot = false;
  for (const PlacedCell& place : place_cell(scenario, options).places) EXPECT_EQ(place.X_WB, scenario.robot->X_WB);
  options.moves_robot = true;
  options.moves_aligner = false;
  for (const PlacedCell& place : place_cell(scenario, options).places) EXPECT_EQ(place.X_WA, scenario.aligner->X_WA);
}

TEST(CellPlace, TurnsWithTheCell) {
  // The same cell, turned about the vertical and shifted as a whole: the same margins and ways.
  const model::Scenario scenario = ur_cell();
  const PlaceSearch here = place_cell(scenario, with_plinth());
  model::Scenario turned = scenario;
  const Pose X_WV{exp_rotation(Vector3(0.0, 0.0, 0.5 * 3.14159265358979323846)), {0.3, -0.2, 0.0}};
  turned.robot->X_WB = X_WV * turned.robot->X_WB;
  turned.aligner->X_WA = X_WV * turned.aligner->X_WA;
  turned.controller.X_WE_start = X_WV * turned.controller.X_WE_start;
  for (model::Container& one : turned.containers) one.X_WT = X_WV * one.X_WT;
  for (model::Body& one : turned.bodies) one.X_WB = X_WV * one.X_WB;
  const PlaceSearch there = place_cell(turned, with_plinth());
  ASSERT_FALSE(here.places.empty());
  ASSERT_FALSE(there.places.empty());
  EXPECT_EQ(there.places.front().reached, here.places.front().reached);
  EXPECT_NEAR(there.places.front().margin, here.places.front().margin, 1e-9);
  EXPECT_NEAR(there.places.front().travel, here.places.front().travel, 1e-9);
}

TEST(CellPlace, AnArmThatIsTooShortIsAnAnswer) {
  model::Scenario scenario = ur_cell();
  for (model::Container& one : scenario.containers) one.inner_size = {2.4, 2.4, 0.2};
  const PlaceSearch search = place_cell(scenario, with_plinth());
  EXPECT_TRUE(search.places.empty());
  EXPECT_NE(format_table(search).find("too short"), std::string::npos);
}

TEST(CellPlace, ProfileKnowsWhatIsReached) {
  const model::Scenario scenario = ur_cell();
  const internal::ReachProfile profile(scenario, -0.3, 0.3, 2);
  // Twice the length of the arm is out of reach, the middle of the ring around it is not, on its axis it is not either.
  EXPECT_LT(profile.depth(1.9, 0.0), 0.0);
  EXPECT_GT(profile.depth(0.5, 0.0), 0.05);
  EXPECT_LT(profile.depth(0.0, 0.0), 0.0);
  EXPECT_LT(profile.depth(0.5, 9.0), 0.0) << "beyond what was looked at";
  EXPECT_GT(profile.reach(), 0.6);
  EXPECT_LT(profile.reach(), 1.0);
  // Depth is a distance: from point to point of its grid of 29 mm it changes by no more than that way, or by two half
  // steps more where the sign changes.
  for (double r = 0.1; r < 0.9; r += 0.01)
    EXPECT_LE(std::abs(profile.depth(r + 0.01, 0.0) - profile.depth(r, 0.0)), 0.031) << r;
}

TEST(CellPlace, RefusesWhatCannotBePlaced) {
  const auto key_of = [](const model::Scenario& scenario, const PlaceOptions& options) {
    try {
      (void)place_cell(scenario, options);
    } catch (const InputError& error) {
      return error.key;
    }
    return std::string("nothing");
  };
  model::Scenario scenario = ur_cell();
  scenario.robot.reset();
  EXPECT_EQ(key_of(scenario, {}), "robot");
  scenario = ur_cell();
  scenario.aligner.reset();
  EXPECT_EQ(key_of(scenario, {}), "aligner");
  scenario = ur_cell();
  scenario.sequences.clear();
  EXPECT_EQ(key_of(scenario, {}), "sequences");
  PlaceOptions options;
  options.stand_with_robot = {"plint"};
  try {
    (void)place_cell(ur_cell(), options);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(error.expected.find("plinth"), std::string::npos);
  }
  EXPECT_EQ(key_of(model::load_scenario(SNUG_SOURCE_DIR "/scenarios/init/gantry.yaml"), {}), "robot.urdf");
}

}  // namespace
}  // namespace snug::runs
