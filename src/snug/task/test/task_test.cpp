// Packing on the demonstrator's cell: what a session promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cell/run.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/other_container.hpp"
#include "snug/motion/limits.hpp"
#include "snug/task/executions.hpp"
#include "snug/task/grasp.hpp"
#include "snug/task/surroundings.hpp"

namespace snug::task {
namespace {

model::Scenario demonstrator() { return model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml"); }

/// The first `count` items of sequence 1 alone.
model::Scenario shortened(std::size_t count) {
  model::Scenario scenario = demonstrator();
  scenario.sequences.front().items.resize(count);
  return scenario;
}

SessionOptions quick() {
  SessionOptions options;
  options.packing.decision_time = 0.05;
  options.samples = 2;
  return options;
}

TEST(Sample, KeepsTheTurnOfBoxesAndStaysWithinTheWidths) {
  const model::Scenario scenario = demonstrator();
  const Uncertainty uncertainty;
  const model::Scenario changed = sample(scenario, "1", uncertainty, Rng(3));
  for (std::size_t i = 0; i < scenario.parcels.size(); ++i) {
    const Vector3 off = changed.parcels[i].size - scenario.parcels[i].size;
    EXPECT_LE(off.cwiseAbs().maxCoeff(), uncertainty.size);
  }
  for (std::size_t i = 0; i < scenario.sequences[0].items.size(); ++i) {
    const Pose before = arrival_pose(scenario, scenario.sequences[0].items[i]);
    const Pose after = arrival_pose(changed, changed.sequences[0].items[i]);
    EXPECT_LE(angle_between(before.R, after.R), uncertainty.yaw + 1e-9) << i;
    // Along Ax and Ay it stands beside its place, and half of what an edge is longer moves its middle; both axes
    // together are sqrt(2) times as far. Its height is half of what the upright edge is longer.
    const double aside = std::numbers::sqrt2 * (uncertainty.position + 0.5 * uncertainty.size);
    EXPECT_LE((before.p - after.p).head<2>().norm(), aside + 1e-12) << i;
    EXPECT_LE(std::abs(before.p.z() - after.p.z()), 0.5 * uncertainty.size + 1e-12) << i;
    EXPECT_GT((before.p - after.p).norm(), 0.0) << i;
  }
}

/// Every box of sequence 1 in every orientation that needs one turn, in cells that are all a little different: the
/// grasp says how it got there, and the box hangs as asked in nearly all of them.
TEST(PlanGrasp, BringsEveryFaceOfEveryTypeUpInNearlyAllCellsThatCouldBe) {
  const model::Scenario scenario = demonstrator();
  const CellLayout layout = make_layout(scenario);
  const cell::SimulationOptions options{motion::ControllerKind::Faithful, cup::CupMode::Phases, {}};
  std::vector<std::unique_ptr<Lane>> lanes;
  std::vector<cell::CellState> states;
  lanes.push_back(std::make_unique<Lane>(scenario, "1", options));
  for (int i = 0; i < 4; ++i) {
    lanes.push_back(std::make_unique<Lane>(sample(scenario, "1", {}, Rng(9).split(std::to_string(i))), "1", options));
  }
  for (const auto& lane : lanes) states.push_back(lane->state());
  const motion::Program nothing;
  const std::function<bool(const Pose&)> everywhere;
  const auto& items = scenario.sequences[0].items;
  double share = 0.0;
  int grasps = 0;
  for (const char* id : {"BOX013", "BOX017", "BOX027", "BOX023"}) {  // one of each type
    const auto item = std::ranges::find(items, id, &model::Item::parcel);
    ASSERT_NE(item, items.end());
    const PlannedBox box = make_planned_box(scenario, scenario.sequences[0], static_cast<int>(item - items.begin()));
    const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * arrival_pose(scenario, *item).R;
    for (int axis = 0; axis < 3; ++axis) {
      packing::Orientation orientation = packing::nearest_orientation(R_AP);
      if (static_cast<int>(orientation.up) == axis) continue;
      orientation.up = static_cast<model::UpAxis>(axis);
      const Grasp grasp = plan_grasp({scenario, layout, lanes, states, nothing, box, 0.0, 1, everywhere}, orientation);
      SCOPED_TRACE(std::string(id) + " axis " + std::to_string(axis));
      EXPECT_EQ(grasp.problem, "");
      EXPECT_NE(grasp.turn, TurnManner::None);
      EXPECT_TRUE(packing::extents(grasp.held_as, box.size).isApprox(packing::extents(orientation, box.size)));
      lanes[0]->restore(grasp.states[0]);
      const Matrix3 R_WP = lanes[0]->pose_of(box.item)->R;
      // Hanging, perhaps still swinging: within the 15 degrees that the grasp itself asks of the samples.
      EXPECT_GT(std::abs(R_WP(2, axis)), std::cos(0.26));
      share += grasp.share;
      ++grasps;
    }
  }
  EXPECT_GE(share / grasps, 0.9);  // what is asked of items in open-loop executions as a whole
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
  const auto variants = choose_variants(measured(empty, corner, size, 0.0), size);
  ASSERT_EQ(variants.size(), 1U);
  EXPECT_EQ(variants[0].manner, PlaceManner::Straight);
}

TEST(Layout, HasNoRimWhereThereAreNoWalls) {
  const model::Scenario scenario = demonstrator();
  EXPECT_NEAR(make_layout(scenario).rim, 0.25, 1e-12);
  EXPECT_EQ(make_layout(model::with_pallet(scenario, "600x400x900")).rim, 0.0);
}

TEST(Pack, LeavesABoxThatIsTooBigForTheContainerWithAReason) {
  const SessionResult result = pack(model::with_container(demonstrator(), "150x150x60"), "1", quick());
  EXPECT_EQ(result.planned_boxes, 0);
  ASSERT_EQ(result.items.size(), 18U);
  for (const ItemReport& item : result.items) EXPECT_EQ(item.reason, "too big for the container") << item.id;
  EXPECT_EQ(result.stopped, "no more items, 18 not packed");
}

TEST(Pack, GoesOnAfterAnItemThatCanNeverFit) {
  model::Scenario scenario = model::with_container(demonstrator(), "320x320x150");  // reads its text anew
  scenario.sequences.front().items.resize(2);
  scenario.parcels[14].size = Vector3(0.3, 0.3, 0.2);  // BOX027, the first item
  ASSERT_EQ(scenario.parcels[14].id, "BOX027");
  for (const char* agent : {"contact-aware", "margin", "manual", "offline"}) {
    SCOPED_TRACE(agent);
    SessionOptions options = quick();
    options.agent = agent;
    options.samples = 0;
    const SessionResult result = pack(scenario, "1", options);
    ASSERT_EQ(result.items.size(), 2U);
    EXPECT_EQ(result.items[0].id, "BOX027");
    EXPECT_EQ(result.items[0].reason, "too big for the container");
    EXPECT_TRUE(result.items[1].is_placed) << result.items[1].reason;
    EXPECT_EQ(result.items[1].samples, 0);
    EXPECT_EQ(result.executed_boxes, 1);
  }
}

TEST(Pack, CarriesItsOwnBox018AsFastAsAnyOther) {
  // The demonstrator slows one waypoint of its own programs, PrePlace018.
  model::Scenario scenario = shortened(1);
  scenario.sequences.front().items.front().parcel = "BOX018";
  scenario.sequences.front().items.front().up = model::UpAxis::Z;
  SessionOptions options = quick();
  options.samples = 0;
  const SessionResult result = pack(scenario, "1", options);
  ASSERT_EQ(result.executed_boxes, 1) << result.stopped;
  const Lane lane(scenario, "1", options.simulation);
  const motion::PreparedProgram plan = lane.simulation().prepare(result.program);
  int rows = 0;
  for (const motion::Waypoint& row : plan.program.waypoints) {
    if (!row.name.starts_with("PrePlace")) continue;
    ++rows;
    EXPECT_EQ(motion::match_limits(row.name, plan.settings.limits)->prefix, "PrePlace") << row.name;
  }
  EXPECT_GE(rows, 1);
}

TEST(Executions, DrawMassesAndSamplesDoNot) {
  const model::Scenario scenario = demonstrator();
  const auto spread = [&](const Uncertainty& uncertainty) {
    const model::Scenario changed = sample(scenario, "1", uncertainty, Rng(3));
    double most = 0.0;
    for (std::size_t i = 0; i < scenario.parcels.size(); ++i) {
      const SpatialInertia &was = scenario.parcels[i].inertia, &is = changed.parcels[i].inertia;
      most = std::max(most, std::abs(is.mass / was.mass - 1.0));
      // 1e-12: rounding. A box that is heavier throughout turns as much harder.
      EXPECT_TRUE(is.inertia.isApprox(is.mass / was.mass * was.inertia, 1e-12));
    }
    return most;
  };
  const double drawn = spread(ExecutionOptions().uncertainty);
  EXPECT_LE(drawn, cell::kMassSpread);
  EXPECT_GT(drawn, 0.5 * cell::kMassSpread);  // the largest of eighteen uniform draws
  EXPECT_EQ(spread(SessionOptions().uncertainty), 0.0);
  // All else is drawn as before.
  model::Scenario with = sample(scenario, "1", ExecutionOptions().uncertainty, Rng(3));
  const model::Scenario without = sample(scenario, "1", {}, Rng(3));
  for (std::size_t i = 0; i < with.parcels.size(); ++i) {
    EXPECT_EQ(with.parcels[i].size, without.parcels[i].size);
    EXPECT_EQ(with.parcels[i].inertia.com, without.parcels[i].inertia.com);
    with.parcels[i].inertia = without.parcels[i].inertia;
  }
  EXPECT_EQ(with, without);
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

TEST(Pack, GivesTheSameWithAnyNumberOfThreadsAndWhenItsProgramIsRunAgain) {
  const model::Scenario scenario = shortened(2);
  SessionOptions options = quick();
  const SessionResult one = pack(scenario, "1", options);
  EXPECT_EQ(one.executed_boxes, 2) << one.stopped;
  options.threads = 2;
  options.packing.threads = 2;
  const SessionResult two = pack(scenario, "1", options);
  EXPECT_EQ(motion::format_program(one.program), motion::format_program(two.program));
  EXPECT_EQ(one.state_hash, two.state_hash);
  cell::RunOptions again;
  again.program = motion::parse_program(motion::format_program(one.program), "again");
  again.sequence = "1";
  again.simulation = options.simulation;
  EXPECT_EQ(cell::run(scenario, again).state_hash, one.state_hash);
}

TEST(Pack, SaysWhyWhenThereIsNothingToDo) {
  const SessionResult nothing = pack(shortened(0), "1", quick());
  EXPECT_EQ(nothing.stopped, "no items");
  EXPECT_TRUE(nothing.program.waypoints.empty());
  EXPECT_EQ(repeat(shortened(0), nothing, {}).items.size(), 0u);

  model::Scenario tiny = shortened(1);
  for (model::Container& container : tiny.containers) container.inner_size = Vector3(0.05, 0.05, 0.05);
  const SessionResult none = pack(tiny, "1", quick());
  EXPECT_EQ(none.executed_boxes, 0);
  EXPECT_FALSE(none.stopped.empty());

  model::Scenario heavy = shortened(1);
  for (model::Parcel& parcel : heavy.parcels) parcel.inertia.mass = 50.0;
  const SessionResult lifted = pack(heavy, "1", quick());
  ASSERT_EQ(lifted.items.size(), 1u);
  EXPECT_FALSE(lifted.items[0].reason.empty());
}

TEST(Pack, RefusesAnUnknownSequenceAndAgent) {
  EXPECT_THROW((void)pack(demonstrator(), "nine", quick()), InputError);
  SessionOptions options = quick();
  options.agent = "nobody";
  EXPECT_THROW((void)pack(shortened(1), "1", options), InputError);
}

}  // namespace
}  // namespace snug::task
