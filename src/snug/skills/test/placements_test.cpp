// Tests of programs made from placements.
#include "snug/skills/placements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "snug/motion/program_csv.hpp"
#include "snug/motion/test/demonstrator.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::skills {
namespace {

using motion::kRounding;

using std::numbers::pi;
constexpr double kRimW = -0.03;
const Pose kX_WT{Matrix3::Identity(), Vector3(0.505, -0.35, -0.282)};

PlacementSettings demonstrator_placement_settings() {
  PlacementSettings settings;
  settings.X_WT = kX_WT;
  settings.rim_height = 0.252;
  settings.obstacle_top = 0.0;
  settings.X_WE_home = {exp_rotation(Vector3(0.0, -pi, 0.0)), Vector3(-0.146, -0.69, 0.206)};
  return settings;
}

/// Stands at the aligner on the belt (z -0.105) with yaw about the vertical.
PickSpec standing(const std::string& box, const Vector3& size, double yaw) {
  PickSpec pick;
  pick.box = box;
  pick.size = size;
  pick.X_WP = {exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(-0.45, -0.4, -0.105 + 0.5 * size.z())};
  return pick;
}

Placement lying(const std::string& box, const Vector3& size, double x, double y, double bottom, double yaw) {
  return {box, {exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(x, y, bottom + 0.5 * size.z())}};
}

struct Job {
  std::vector<PickSpec> picks;
  std::vector<Placement> placements;
  PlacementSettings settings = demonstrator_placement_settings();
};

Job two_boxes() {
  const Vector3 small(0.17, 0.236, 0.095);
  const Vector3 tall(0.205, 0.3, 0.2);
  Job job;
  job.picks = {standing("BOX027", small, 0.0), standing("BOX013", tall, 0.5 * pi)};
  job.placements = {lying("BOX027", small, -0.05, -0.1, 0.0, 0.5 * pi), lying("BOX013", tall, -0.05, -0.1, 0.095, 2.5)};
  return job;
}

motion::Program program_of(const Job& job) {
  const auto program = program_from_placements(job.picks, job.placements, job.settings);
  EXPECT_TRUE(program.has_value()) << (program ? "" : program.error().text);
  return program.value_or(motion::Program{});
}

NoProgram refusal_of(const Job& job) {
  const auto program = program_from_placements(job.picks, job.placements, job.settings);
  EXPECT_FALSE(program.has_value());
  if (program) return NoProgram::UnknownBox;
  EXPECT_NE(program.error().text.find(program.error().box), std::string::npos);
  return program.error().reason;
}

TEST(Placements, GiveTheRowsAndSwitchesOfAPickAndPlace) {
  const motion::Program program = program_of(two_boxes());
  const std::vector<std::string> names = {"PrePick(BOX027)",
                                          "Box(BOX027)",
                                          "PostPick(BOX027)",
                                          "PrePlace(BOX027)",
                                          "PrePlace(BOX027)_2",
                                          "Place(BOX027)",
                                          "Place(BOX027)",
                                          "PostPlace(BOX027)",
                                          "PrePick(BOX013)",
                                          "Box(BOX013)",
                                          "PostPick(BOX013)",
                                          "PrePlace(BOX013)",
                                          "PrePlace(BOX013)_2",
                                          "Place(BOX013)",
                                          "Place(BOX013)",
                                          "PostPlace(BOX013)",
                                          "home"};
  const std::string vacuum = "00111100001111000";
  const std::string blow = "00000010000000100";
  ASSERT_EQ(program.waypoints.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(motion::name_of(program.waypoints[i]), names[i]);
    EXPECT_EQ(program.waypoints[i].io, (motion::IO{.vacuum = vacuum[i] == '1', .blow_off = blow[i] == '1'}))
        << names[i];
  }
  EXPECT_EQ(program.waypoints.back(),
            motion::make_waypoint(motion::MotionClass::Home, {}, two_boxes().settings.X_WE_home));
}

TEST(Placements, PutTheRigidlyHeldBoxWhereItShallRest) {
  Job job = two_boxes();
  job.settings.tool_yaw = 0.7;
  job.picks[1].tool_yaw = -2.0;
  job.picks[1].cup_offset = Vector3(0.03, -0.04, 0.0);
  job.settings.release_gap = 0.002;
  const motion::Program program = program_of(job);
  for (std::size_t b = 0; b < 2; ++b) {
    SCOPED_TRACE(b);
    const Pose& X_WE_pick = program.waypoints[8 * b + 1].X_WE;
    const Pose& X_WE_place = program.waypoints[8 * b + 5].X_WE;
    EXPECT_EQ(program.waypoints[8 * b + 6].X_WE, X_WE_place);
    // Between pressing and hanging the cup stretches by hold_length - pick_length, straight up.
    Pose X_WE_hang = X_WE_pick;
    X_WE_hang.p.z() += job.settings.hold_length - job.settings.pick_length;
    Pose X_WP = X_WE_place * (X_WE_hang.inverse() * job.picks[b].X_WP);
    X_WP.p.z() -= job.settings.release_gap;
    const Pose X_WP_wanted = kX_WT * job.placements[b].X_TP;
    EXPECT_LT((X_WP.p - X_WP_wanted.p).norm(), 1e-14);  // roundings of metres
    EXPECT_LT(angle_between(X_WP.R, X_WP_wanted.R), 1e-14);
    // The cup presses on the chosen point of the top face, z of E down.
    const Vector3 pressed =
        job.picks[b].X_WP * Vector3(job.picks[b].cup_offset + 0.5 * job.picks[b].size.z() * Vector3::UnitZ());
    EXPECT_LT((X_WE_pick.p - pressed - job.settings.pick_length * Vector3::UnitZ()).norm(), 1e-14);
    EXPECT_LT((X_WE_pick.R.col(2) + Vector3::UnitZ()).norm(), 1e-14);
  }
}

TEST(Placements, GoStraightDownAndUp) {
  const motion::Program program = program_of(two_boxes());
  for (const auto& [first, last] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 2}, {3, 7}, {8, 10}, {11, 15}}) {
    for (std::size_t i = first; i <= last; ++i) {
      EXPECT_EQ(program.waypoints[i].X_WE.R, program.waypoints[first].X_WE.R) << i;
      EXPECT_EQ(program.waypoints[i].X_WE.p.head<2>(), program.waypoints[first].X_WE.p.head<2>()) << i;
    }
  }
}

TEST(Placements, CrossAboveRimObstacleAndPackedBoxes) {
  Job job = two_boxes();
  job.settings.entry_clearance = std::nullopt;
  const motion::Program program = program_of(job);
  ASSERT_EQ(program.waypoints.size(), 15u);
  const double clearance = job.settings.travel_clearance;
  double highest = std::max(kRimW, job.settings.obstacle_top);
  for (std::size_t b = 0; b < 2; ++b) {
    SCOPED_TRACE(b);
    const auto z = [&](std::size_t i) { return program.waypoints[7 * b + i].X_WE.p.z(); };
    const double carried_below_tool = job.settings.hold_length + job.picks[b].size.z();
    EXPECT_EQ(z(2), z(3));  // PostPick to PrePlace: level
    EXPECT_GE(z(2) - carried_below_tool, highest + clearance - 1e-12);
    highest = std::max(highest, (kX_WT * job.placements[b].X_TP).p.z() + 0.5 * job.picks[b].size.z());
    EXPECT_GE(z(6) - job.settings.free_length, highest + clearance - 1e-12);  // PostPlace
    EXPECT_GE(z(0), z(1) + clearance);                                        // PrePick above the box
  }
  EXPECT_EQ(program.waypoints[6].X_WE.p.z(), program.waypoints[7].X_WE.p.z());  // PostPlace to PrePick: level
  EXPECT_GT(highest, 0.0);  // the second box stands above rim and obstacle, so it was what had to be cleared
}

TEST(Placements, StopAboveTheNeighboursBeforeGoingDownBetweenThem) {
  const Job job = two_boxes();
  const motion::Program program = program_of(job);
  const double bottom = program.waypoints[4].X_WE.p.z() - job.settings.hold_length - job.picks[0].size.z();
  EXPECT_NEAR(bottom, kRimW + *job.settings.entry_clearance, 1e-14);
}

TEST(Placements, TurnABoxThatLiesOnItsSideAboutTheVerticalOnly) {
  Job job = two_boxes();
  const Matrix3 R_side = exp_rotation(Vector3(0.5 * pi, 0.0, 0.0));  // Py up
  job.picks[0].X_WP.R = exp_rotation(Vector3(0.0, 0.0, 1.0)) * R_side;
  job.picks[0].X_WP.p.z() = -0.105 + 0.5 * job.picks[0].size.y();
  job.placements[0].X_TP.R = exp_rotation(Vector3(0.0, 0.0, -2.0)) * R_side;
  job.placements[0].X_TP.p.z() = 0.5 * job.picks[0].size.y();
  const motion::Program program = program_of(job);
  EXPECT_NEAR(program.waypoints[1].X_WE.p.z(), -0.105 + job.picks[0].size.y() + job.settings.pick_length, 1e-14);
  EXPECT_LT((program.waypoints[5].X_WE.R.col(2) + Vector3::UnitZ()).norm(), 1e-14);
}

TEST(Placements, AreRefusedWithTheReason) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Job job = two_boxes();
  job.placements[1].box = "BOX099";
  EXPECT_EQ(refusal_of(job), NoProgram::UnknownBox);
  job = two_boxes();
  job.placements[1] = job.placements[0];
  EXPECT_EQ(refusal_of(job), NoProgram::PlacedTwice);
  for (const Vector3& turn : {Vector3(0.5 * pi, 0.0, 0.0), Vector3(0.0, pi, 0.0), Vector3(0.0, -0.5 * pi, 0.0)}) {
    job = two_boxes();
    job.placements[0].X_TP.R = exp_rotation(turn);
    EXPECT_EQ(refusal_of(job), NoProgram::NeedsFlip);
  }
  job = two_boxes();
  job.placements[0].X_TP.R = exp_rotation(Vector3(0.1, 0.0, 0.0));
  EXPECT_EQ(refusal_of(job), NoProgram::TiltedPlacement);
  job = two_boxes();
  job.picks[0].X_WP.R = exp_rotation(Vector3(0.1, 0.0, 0.0));
  EXPECT_EQ(refusal_of(job), NoProgram::NotUpright);
  job = two_boxes();
  job.picks[0].cup_offset = Vector3(0.1, 0.0, 0.0);
  EXPECT_EQ(refusal_of(job), NoProgram::BadNumber);
  const std::vector<void (*)(Job&, double)> spoilers = {
      [](Job& j, double value) { j.picks[0].size.x() = value; },
      [](Job& j, double value) { j.picks[0].X_WP.p.x() = value; },
      [](Job& j, double value) { j.placements[0].X_TP.R(0, 0) = value; },
      [](Job& j, double value) { j.settings.travel_clearance = value; },
      [](Job& j, double value) { j.picks[0].cup_offset.z() = value; },
  };
  for (const auto spoil : spoilers) {
    job = two_boxes();
    spoil(job, nan);
    EXPECT_EQ(refusal_of(job), NoProgram::BadNumber);
  }
}

TEST(Placements, OfNothingSendTheToolHome) {
  Job job = two_boxes();
  job.placements.clear();
  const motion::Program program = program_of(job);
  ASSERT_EQ(program.waypoints.size(), 1u);
  EXPECT_EQ(motion::name_of(program.waypoints[0]), "home");
}

TEST(Placements, GiveAProgramThatReadsBackAndRuns) {
  const motion::Program program = program_of(two_boxes());
  const motion::Program again = motion::parse_program(motion::format_program(program), "placements.csv");
  ASSERT_EQ(again.waypoints.size(), program.waypoints.size());
  for (const motion::Tracking& tracking :
       {motion::Tracking(motion::LaggedTracking{}), motion::Tracking(motion::ExactTracking{})}) {
    motion::ControllerSettings settings = motion::demonstrator_settings(1);
    settings.tracking = tracking;
    const double duration = motion::compute_duration(motion::prepare(again, settings), program.waypoints.back().X_WE);
    EXPECT_GT(duration, 10.0);
    EXPECT_LT(duration, 60.0);
  }
}

TEST(Placements, AreEnteredByTheLaggedToolFarWithinTheGapsBetweenBoxes) {
  // What the stop PrePlace(...)_2 is for: boxes are packed with 1 mm between them.
  const Job job = two_boxes();
  const motion::Program program = program_of(job);
  const motion::PreparedProgram plan = motion::prepare(program, motion::demonstrator_settings(1));
  motion::ControllerState state = motion::make_controller_state(program.waypoints.back().X_WE);
  motion::ToolState measured = state.command;
  const Pose& X_WE_place = program.waypoints[5].X_WE;
  double worst = 0.0;
  while (state.row < 6) {
    measured = motion::tick(plan, measured, state).tool;
    const double bottom = measured.X_WE.p.z() - job.settings.hold_length - job.picks[0].size.z();
    if (state.row >= 4 && bottom < kRimW) worst = std::max(worst, (measured.X_WE.p - X_WE_place.p).head<2>().norm());
  }
  EXPECT_GT(worst, 0.0);
  // The tool leaves the stop with up to 5 mm of error, spent along a way that is nearly straight down; a third of the
  // gap.
  EXPECT_LT(worst, 3e-4);
  RecordProperty("worst_mm", std::to_string(1000.0 * worst));
}

}  // namespace
}  // namespace snug::skills
