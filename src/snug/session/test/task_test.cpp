// Task: placements into a program that passes over what is fixed, or the reason why not.
#include "snug/session/task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/planning/test/demonstrator.hpp"

namespace snug::session {
namespace {

using planning::demonstrator;

const std::filesystem::path kSource = SNUG_SOURCE_DIR;

/// The tests of cells run this program.
TEST(DemoProgram, IsTheOneThatCellsAreTestedWith) {
  const auto file = kSource / "scenarios/demo-placements.yaml";
  const auto program = make_program(demonstrator(), "1", model::load_placements(file, demonstrator()), file.string());
  ASSERT_TRUE(program.has_value());
  EXPECT_EQ(motion::format_program(*program),
            read_file(kSource / "src/snug/cell/test/demo_program.csv", "the demo program"));
}

TEST(DemoProgram, SaysWhyABoxThatWouldNeedAFlipHasNone) {
  model::PlacementEntry lying;
  lying.parcel = "BOX027";  // stands with Z up
  lying.X_TP = {exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, 0.12)};
  const auto program = make_program(demonstrator(), "1", {lying}, "list.yaml");
  ASSERT_FALSE(program.has_value());
  EXPECT_EQ(program.error().reason, skills::NoProgram::NeedsFlip);
  EXPECT_EQ(program.error().box, "BOX027");
}

TEST(DemoProgram, RefusesUnknownSequencesAndBoxes) {
  model::PlacementEntry entry;
  entry.parcel = "BOX999";
  entry.line = 7;
  EXPECT_THROW((void)make_program(demonstrator(), "nine", {}, "list.yaml"), InputError);
  try {
    (void)make_program(demonstrator(), "1", {entry}, "list.yaml");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "list.yaml:7");
    EXPECT_EQ(error.key, "box");
  }
}

TEST(MakeProgram, CrossesTheCellOverAHull) {
  const auto file = kSource / "scenarios/demo-placements.yaml";
  const auto highest_carry = [&](const model::Scenario& scenario) {
    const auto program = make_program(scenario, "1", model::load_placements(file, scenario), file.string());
    EXPECT_TRUE(program.has_value());
    double lowest = 10.0;
    for (const motion::Waypoint& row : program->waypoints) {
      if (row.motion_class == motion::MotionClass::PostPick) lowest = std::min(lowest, row.X_WE.p.z());
    }
    return lowest;
  };
  const auto pyramid = geometry::make_convex_hull(
      std::vector<Vector3>{{-0.1, -0.1, 0.0}, {0.1, -0.1, 0.0}, {0.0, 0.1, 0.0}, {0.0, 0.0, 0.3}});
  ASSERT_TRUE(pyramid.has_value());
  model::Scenario blocked = demonstrator();
  model::Body post;
  post.name = "post";
  post.kind = model::BodyKind::Static;
  post.shapes.push_back({*pyramid, Pose{}});
  post.X_WB.p = Vector3(0.0, -0.4, 0.1);
  blocked.bodies.push_back(post);
  EXPECT_NEAR(highest_carry(blocked) - highest_carry(demonstrator()), 0.4, 1e-9) << "the bench is at 0";
}

}  // namespace
}  // namespace snug::session
