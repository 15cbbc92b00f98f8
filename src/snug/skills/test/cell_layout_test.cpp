// CellLayout: where boxes are flipped, what travels pass over, and what a cell must have.
#include "snug/skills/cell_layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/skills/highest_fixed_point.hpp"
#include "snug/skills/test/demonstrator.hpp"

namespace snug::skills {
namespace {

model::Body bench(const Vector3& half, const Vector3& p_WB) {
  model::Body body;
  body.name = "bench";
  body.kind = model::BodyKind::Static;
  body.shapes.push_back({geometry::Box{half}, Pose{}});
  body.X_WB.p = p_WB;
  return body;
}

/// The demonstrator's cell with these bodies alone, its aligner at the origin and its container 1 m along x.
model::Scenario cell_with(std::vector<model::Body> bodies) {
  model::Scenario scenario = demonstrator();
  scenario.bodies = std::move(bodies);
  scenario.aligner->X_WA.p.setZero();
  scenario.containers[0].X_WT.p = Vector3(1.0, 0.0, 0.0);
  return scenario;
}

std::optional<FlipPlace> flip_place(const model::Scenario& scenario) {
  return make_layout(scenario, std::nullopt).flip_place;
}

TEST(FlipPlace, IsOnTheHighestSurfaceAndOfEqualOnesOnTheNearest) {
  const Vector3 half(0.3, 0.3, 0.05);
  const model::Body near_low = bench(half, Vector3(0.5, 0.0, 0.0)), far_high = bench(half, Vector3(0.5, 3.0, 0.1));
  const model::Body farther_high = bench(half, Vector3(0.5, -4.0, 0.1));
  for (auto bodies : {std::vector{near_low, far_high, farther_high}, std::vector{farther_high, far_high, near_low}}) {
    const auto place = flip_place(cell_with(bodies));
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->p_WF.z(), 0.15, 1e-12);
    EXPECT_NEAR(place->p_WF.y(), 3.0 - 0.3 + 0.16, 1e-12) << "the edge of it that is nearest the way, less the room";
  }
}

TEST(FlipPlace, NeedsTheRoomOfTheDragOnTheSideOfTheContainerAlone) {
  const settings::PivotParams params = demonstrator().skills.pivot;
  const double along = params.surface_room + 0.5 * params.surface_drag, across = params.surface_room;
  for (const double more : {-1e-6, 1e-6}) {
    const auto is_large_enough = [&](double x, double y) {
      return flip_place(cell_with({bench(Vector3(x, y, 0.05), Vector3(0.5, 0.0, 0.0))})).has_value();
    };
    EXPECT_EQ(is_large_enough(along + more, across + 1e-6), more > 0.0);
    EXPECT_EQ(is_large_enough(along + 1e-6, across + more), more > 0.0);
  }
  const auto place = flip_place(cell_with({bench(Vector3(along + 1e-6, 0.3, 0.05), Vector3(0.5, 0.0, 0.0))}));
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->p_WF.x() - (0.5 - along), params.surface_room, 1e-5) << "behind";
  EXPECT_NEAR((0.5 + along) - place->p_WF.x(), params.surface_room + params.surface_drag, 1e-5) << "before";
}

TEST(FlipPlace, LiesOnATurnedBenchWithTheRoomOfTheDrag) {
  const settings::PivotParams params = demonstrator().skills.pivot;
  int found = 0;
  for (int i = 0; i < 36; ++i) {
    SCOPED_TRACE(i);
    const Vector3 half(0.45, 0.65, 0.05);
    model::Body turned = bench(half, Vector3(0.5, 0.6, 0.0));
    turned.X_WB.R = exp_rotation(Vector3(0.0, 0.0, 0.0873 * i));
    const auto place = flip_place(cell_with({turned}));
    if (!place) continue;
    ++found;
    for (const double drag : {0.0, params.surface_drag}) {
      const Vector3 p_B = turned.X_WB.inverse() * (place->p_WF + drag * place->direction);
      EXPECT_LE(std::abs(p_B.x()), half.x() + 1e-12);
      EXPECT_LE(std::abs(p_B.y()), half.y() + 1e-12);
    }
  }
  EXPECT_GT(found, 18);
}

TEST(FlipPlace, IsNotOnWhatMovesLeansOrIsRound) {
  const Vector3 half(0.4, 0.4, 0.05), p(0.5, 0.0, 0.0);
  EXPECT_TRUE(flip_place(cell_with({bench(half, p)})));
  EXPECT_FALSE(flip_place(cell_with({})));
  for (const model::BodyKind kind : {model::BodyKind::Dynamic, model::BodyKind::Kinematic}) {
    model::Body moving = bench(half, p);
    moving.kind = kind;
    EXPECT_FALSE(flip_place(cell_with({moving})));
  }
  model::Body leaning = bench(half, p);
  leaning.X_WB.R = exp_rotation(Vector3(0.0, 0.01, 0.0));
  EXPECT_FALSE(flip_place(cell_with({leaning})));
  model::Body round = bench(half, p);
  round.shapes[0].shape = geometry::Capsule{.half_length = 0.5, .radius = 0.5};
  EXPECT_FALSE(flip_place(cell_with({round})));
  // What leans in its body and stands level with it counts.
  leaning.shapes[0].X_BG.R = leaning.X_WB.R.transpose();
  EXPECT_TRUE(flip_place(cell_with({leaning})));
}

TEST(Layout, IsRefusedWithoutAlignerToolOrTarget) {
  const auto is_refused = [](const model::Scenario& scenario) {
    try {
      (void)make_layout(scenario, std::nullopt);
    } catch (const InputError& error) {
      return error.where == scenario.source_name;
    }
    return false;
  };
  EXPECT_FALSE(is_refused(demonstrator()));
  model::Scenario scenario = demonstrator();
  scenario.aligner.reset();
  EXPECT_TRUE(is_refused(scenario));
  scenario = demonstrator();
  scenario.tool.reset();
  EXPECT_TRUE(is_refused(scenario));
  scenario = demonstrator();
  scenario.target = "tote3";
  EXPECT_TRUE(is_refused(scenario));
  scenario = demonstrator();
  scenario.containers.clear();
  EXPECT_TRUE(is_refused(scenario));
}

TEST(TravelBottom, IsTheClearanceOverTheHighestOfFixedThingsRimAndPackedBoxes) {
  Rng rng(11);
  for (int i = 0; i < 100; ++i) {
    CellLayout layout;
    layout.X_WT.p.z() = rng.uniform(-1.0, 1.0);
    layout.rim = rng.uniform(0.0, 0.5);
    layout.fixed_top = rng.uniform(-1.0, 1.0);
    layout.travel.clearance = rng.uniform(0.0, 0.2);
    layout.travel.turning_clearance = rng.uniform(0.0, 0.2);
    layout.is_fast = i % 2 == 0;
    const double packed = rng.uniform(0.0, 1.0);
    const double bottom = travel_bottom(layout, packed) - crossing_clearance(layout);
    EXPECT_EQ(crossing_clearance(layout),
              i % 2 == 0 ? layout.travel.turning_clearance + 0.005 : layout.travel.clearance);
    const double tops[] = {layout.X_WT.p.z() + layout.rim, layout.X_WT.p.z() + packed, layout.fixed_top};
    EXPECT_NEAR(bottom, *std::ranges::max_element(tops), 1e-12);
  }
}

TEST(HighestFixedPoint, IsTheUppermostCornerOfWhatLeansAndNothingThatMoves) {
  model::Body post = bench(Vector3(0.1, 0.1, 0.5), Vector3::Zero());
  post.X_WB.R = exp_rotation(Vector3(0.0, 0.4, 0.0));
  EXPECT_NEAR(highest_fixed_point(cell_with({post})), 0.5 * std::cos(0.4) + 0.1 * std::sin(0.4), 1e-12);
  const double without = highest_fixed_point(cell_with({}));
  post.kind = model::BodyKind::Dynamic;
  EXPECT_EQ(highest_fixed_point(cell_with({post})), without);
}

}  // namespace
}  // namespace snug::skills
