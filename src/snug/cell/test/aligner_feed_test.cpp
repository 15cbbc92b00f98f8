// Boxes at the aligner: in its corner, turned as the picks of a program say, from above or by a side.
#include "snug/cell/aligner_feed.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::cell {
namespace {

/// The item that a waypoint of this name comes for, or -1.
int find_pick(const model::Sequence& sequence, const std::string& name) {
  const motion::Waypoint waypoint = motion::parse_waypoint_name(name);
  return waypoint.motion_class == motion::MotionClass::PrePick ? find_item(sequence, waypoint) : -1;
}

TEST(FindItem, MatchesTheNumberAfterThePrefix) {
  const model::Sequence& sequence = *model::find_sequence(demonstrator(), "1");
  EXPECT_EQ(find_pick(sequence, "PrePick027"), 0);
  EXPECT_EQ(find_pick(sequence, "PrePick013_seq3"), 2);
  EXPECT_EQ(find_pick(sequence, "PrePick_022"), 17);
  EXPECT_EQ(find_pick(sequence, "Box027"), -1);
  EXPECT_EQ(find_pick(sequence, "PrePick"), -1);
  EXPECT_EQ(find_pick(sequence, "PrePick099"), -1);
  EXPECT_EQ(find_pick(sequence, ""), -1);
  EXPECT_EQ(find_pick(sequence, "PrePick7"), -1);
  EXPECT_EQ(find_pick(sequence, "PrePick27"), -1);
}

TEST(FindItem, KnowsBoxesWithAnyIdByTheNamesThatOurRowsHave) {
  model::Sequence sequence;
  for (const char* id : {"BOX11", "BOX1", "A12B", "crate", "crate_turn", "11", "a (b) c"}) {
    sequence.items.push_back({});
    sequence.items.back().parcel = id;
  }
  for (std::size_t i = 0; i < sequence.items.size(); ++i) {
    const std::string& id = sequence.items[i].parcel;
    EXPECT_EQ(find_item(sequence, motion::make_waypoint(motion::MotionClass::PrePick, id, Pose{})), static_cast<int>(i))
        << id;
    EXPECT_EQ(find_item(sequence, motion::make_waypoint(motion::MotionClass::PrePick, id, Pose{}, {}, "_turn")),
              static_cast<int>(i))
        << id;
  }
  EXPECT_EQ(find_pick(sequence, "PrePick1"), 1);
  EXPECT_EQ(find_pick(sequence, "PrePickA12B"), 2);
  EXPECT_EQ(find_pick(sequence, "PrePickcrate_2"), 3);
  EXPECT_EQ(find_pick(sequence, "PrePick11"), 5);
}

TEST(PoseAtAligner, StandsInTheCornerOnTheBeltWithTheWantedAxisUp) {
  const model::Scenario& scenario = demonstrator();
  for (const model::Sequence& sequence : scenario.sequences) {
    for (const model::Item& item : sequence.items) {
      SCOPED_TRACE(sequence.name + " " + item.parcel);
      const Pose X_WP = pose_at_aligner(scenario, item, std::nullopt);
      const Pose X_AP = scenario.aligner->X_WA.inverse() * X_WP;
      const Vector3 half = 0.5 * model::collision_size(scenario, *model::find_parcel(scenario, item.parcel));
      const Vector3 reach = X_AP.R.cwiseAbs() * half;
      // 1e-9: rounding of rotations that are written with 15 digits
      EXPECT_NEAR(X_AP.p.x() - reach.x(), 0.0, 1e-9);
      EXPECT_NEAR(X_AP.p.y() - reach.y(), 0.0, 1e-9);
      EXPECT_NEAR(X_WP.p.z() - (X_WP.R.cwiseAbs() * half).z(), scenario.aligner->support_height, 1e-9);
      EXPECT_EQ(vertical_axis(X_WP.R), static_cast<int>(item.up));
    }
  }
}

/// Where the cup is when the vacuum comes on for a box: the row before the first with vacuum after its PrePick.
std::optional<Pose> pick_pose(const motion::Program& program, const std::string& number) {
  bool approaches = false;
  for (std::size_t i = 0; i < program.waypoints.size(); ++i) {
    approaches = approaches || motion::name_of(program.waypoints[i]).starts_with("PrePick" + number);
    if (approaches && program.waypoints[i].io.vacuum) return program.waypoints[i - 1].X_WE;
  }
  return std::nullopt;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST(PoseAtAligner, TurnsEachBoxAsThePicksOfTheRealProgramsSay) {
  const auto folder = kSource / "../shared/data/waypoints";
  std::ifstream file(folder / "initial_poses.csv");
  if (!file) GTEST_SKIP() << "no initial_poses.csv in " << folder;
  const model::Scenario& scenario = demonstrator();
  int checked = 0;
  std::string line;
  std::getline(file, line);  // header
  while (std::getline(file, line)) {
    SCOPED_TRACE(line);
    const std::vector<std::string> cells = split(line);
    const auto program = motion::load_program(folder / ("poses" + cells[0] + "real.csv"));
    const model::Sequence& sequence = *model::find_sequence(scenario, cells[0]);
    const std::string number = "0" + cells[1];
    const int index = find_pick(sequence, "PrePick" + number);
    const auto X_WE = pick_pose(program, number);
    ASSERT_TRUE(index >= 0 && X_WE);
    const Pose X_WP = pose_at_aligner(scenario, sequence.items[static_cast<std::size_t>(index)], X_WE);
    const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * X_WP.R;
    EXPECT_EQ(axis_letter(vertical_axis(X_WP.R)), cells[2][0]);
    int along_x = 0;
    R_AP.row(0).cwiseAbs().maxCoeff(&along_x);
    EXPECT_EQ(static_cast<char>(axis_letter(along_x) - 'X' + 'x'), cells[3][cells[3].find('(') + 1]);
    const Vector3 up_in_A = R_AP.col(2);  // Pz: away from the heavy plate
    const bool along_A_x = cells[5].starts_with("+z along +A.x");
    const bool along_A_y = cells[5].starts_with("+z along +A.y");
    EXPECT_NEAR(along_A_x ? up_in_A.x() : along_A_y ? up_in_A.y() : up_in_A.z(), 1.0, 1e-9);
    ++checked;
  }
  EXPECT_EQ(checked, 37);
}

/// A tool that comes from 8 degrees above level and touches the middle of a side of the box, pressed as packed programs
/// press there.
Pose side_pick_of(const Pose& X_WP, const Vector3& size, const Vector3& face) {
  const Vector3 level_axis = Vector3::UnitZ().cross(face);
  const Matrix3 R_WE = exp_rotation((0.5 * std::numbers::pi - 0.14) * level_axis) * motion::upright_tool(0.0);
  const Vector3 touched = X_WP.p + 0.5 * (X_WP.R.transpose() * face).cwiseAbs().dot(size) * face;
  return {R_WE, touched - cup::pick_length(demonstrator().cup) * R_WE.col(2)};
}

TEST(PoseAtAligner, IsTheSameForPicksFromAboveAndByASideHoweverNearlySquareTheBoxIs) {
  const model::Scenario& scenario = demonstrator();
  const Matrix3& R_WA = scenario.aligner->X_WA.R;
  int sides = 0;
  for (const model::Sequence& sequence : scenario.sequences) {
    for (const model::Item& item : sequence.items) {
      const Vector3 size = model::collision_size(scenario, *model::find_parcel(scenario, item.parcel));
      for (const double yaw : {0.0, 0.5 * std::numbers::pi}) {
        model::Item turned = item;
        turned.yaw = yaw;
        const Pose X_WP = pose_at_aligner(scenario, turned, std::nullopt);
        const Pose above{motion::upright_tool(0.0), X_WP.p};
        // Boxes as long as broad look the same both ways; the heavy side decides of those that are tipped.
        if (!pose_at_aligner(scenario, item, above).R.isApprox(X_WP.R, 1e-9)) continue;
        for (const Vector3& face : {Vector3(R_WA.col(0)), Vector3(R_WA.col(1))}) {
          SCOPED_TRACE(sequence.name + " " + item.parcel);
          EXPECT_TRUE(pose_at_aligner(scenario, item, side_pick_of(X_WP, size, face)).R.isApprox(X_WP.R, 1e-9));
          ++sides;
        }
      }
    }
  }
  // At least one of both turns of every item, two sides each.
  EXPECT_GE(sides, 2 * 5 * 18);
}

TEST(PoseAtAligner, StandsBesideItsPlaceByWhatTheItemSays) {
  const model::Scenario& scenario = demonstrator();
  model::Item item = scenario.sequences[0].items[0];
  item.yaw = 0.0;
  const Pose before = pose_at_aligner(scenario, item, std::nullopt);
  item.shift_A = Vector3(0.003, -0.002, 0.0);
  item.turn = 0.01;
  const Pose after = pose_at_aligner(scenario, item, std::nullopt);
  EXPECT_TRUE((scenario.aligner->X_WA.R.transpose() * (after.p - before.p)).isApprox(item.shift_A, 1e-12));
  EXPECT_TRUE((after.R * before.R.transpose()).isApprox(exp_rotation(Vector3(0.0, 0.0, 0.01)), 1e-12));
}

}  // namespace
}  // namespace snug::cell
