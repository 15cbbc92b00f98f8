// Check: what a look at a program says beforehand, beside what a run does.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/test/demonstrator.hpp"
#include "snug/cup/phases.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_check.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/test/robot_rows.hpp"

namespace snug::runs {
namespace {

using cell::demonstrator;
using cell::kSource;
using cell::pose_at_aligner;
using cell::Simulation;
using cell::StopCause;

using test::BallWrist;
using test::home;
using test::into_the_wall;
using test::row_at;
using test::simulate;
using test::turned_tool;
using test::wrist_into_the_wall;

CheckResult check(std::vector<motion::Waypoint> rows, const std::string& sequence = "1") {
  CheckOptions options;
  options.sequence = sequence;
  return check_program(demonstrator(), motion::Program{"test", std::move(rows)}, options);
}

const CheckFinding* find(const std::vector<CheckFinding>& findings, CheckKind kind) {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](const CheckFinding& finding) { return finding.kind == kind; });
  return found == findings.end() ? nullptr : &*found;
}

TEST(Check, DoesNotWindUpAWristThatTheControllerTakesThroughItsSingularity) {
  // Ten times around the direction in which two axes fall together: whoever follows the path exactly winds both up by
  // ten turns, 60 rad past limits of 6.1. The controller lets the tool give way by a degree.
  std::vector<motion::Waypoint> rows;
  for (int round = 0; round < 10; ++round) {
    for (const auto& [pitch, yaw] : {std::pair{-0.3, 0.01}, {0.3, 0.01}, {0.3, -0.01}, {-0.3, -0.01}}) {
      rows.push_back(turned_tool(pitch, yaw));
    }
  }
  const BallWrist cell;
  const RunResult run = simulate(cell.scenario, rows);
  EXPECT_FALSE(run.stop) << run.failure.text;
  CheckOptions options;
  const CheckResult result = check_program(cell.scenario, motion::Program{"test", rows}, options);
  EXPECT_EQ(find(result.findings, CheckKind::JointLimit), nullptr);
  EXPECT_EQ(find(result.findings, CheckKind::Reach), nullptr);
  EXPECT_NEAR(result.duration, run.duration, 0.02);
  EXPECT_NE(find(result.findings, CheckKind::Singularity), nullptr);
  // One line for all rows.
  const std::vector<CheckGroup> groups = group(result.findings);
  const auto singular = std::find_if(groups.begin(), groups.end(),
                                     [](const CheckGroup& one) { return one.worst.kind == CheckKind::Singularity; });
  ASSERT_NE(singular, groups.end());
  EXPECT_GE(singular->rows.size(), 15u);
  EXPECT_TRUE(std::is_sorted(singular->rows.begin(), singular->rows.end()));
}

TEST(Check, StopsAtALimitWhereTheRunDoes) {
  // The tool's own axis turned on and on: the last joint ends at its limit.
  std::vector<motion::Waypoint> rows;
  for (int i = 0; i <= 8; ++i) {
    rows.push_back(turned_tool(-0.3, 0.0));
    const Pose X_WE = rows.back().X_WE;
    rows.back().X_WE = {X_WE.R * exp_rotation(Vector3(0.0, 0.0, 1.0 * i)), X_WE.p};
  }
  const BallWrist cell;
  const RunResult run = simulate(cell.scenario, rows);
  ASSERT_TRUE(run.stop);
  EXPECT_EQ(run.stop->cause, StopCause::Stuck);
  const CheckResult result = check_program(cell.scenario, motion::Program{"test", rows}, {});
  const CheckFinding* reach = find(result.findings, CheckKind::Reach);
  ASSERT_NE(reach, nullptr);
  EXPECT_EQ(reach->row, run.stop->row);
  EXPECT_NE(reach->what.find("a6 at its upper limit"), std::string::npos) << reach->what;
  EXPECT_EQ(find(result.findings, CheckKind::JointLimit), nullptr);
}

TEST(Check, SaysHowFarTheCupIsInsideAndHowFarItMay) {
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  // The cup's ball of 30 mm lies 18 mm beyond E.
  const auto press = [&](double depth) {
    return check({row_at(tote.X_WT * Vector3(0.0, 0.0, 0.4)), row_at(tote.X_WT * Vector3(0.0, 0.0, 0.048 - depth))},
                 "");
  };
  const std::string what = "cup - " + demonstrator().target;
  const auto is_cup = [&](const CheckFinding& finding) { return finding.what == what; };
  const CheckResult allowed = press(0.02), beyond = press(0.04);
  EXPECT_TRUE(allowed.is_ok);
  const auto margin = std::find_if(allowed.margins.begin(), allowed.margins.end(), is_cup);
  ASSERT_NE(margin, allowed.margins.end());
  EXPECT_NEAR(margin->margin, -0.02, 0.006);  // the row is reached within 5 mm
  EXPECT_EQ(margin->allowance, 0.03);
  EXPECT_FALSE(beyond.is_ok);
  const auto finding = std::find_if(beyond.findings.begin(), beyond.findings.end(), is_cup);
  ASSERT_NE(finding, beyond.findings.end());
  EXPECT_NEAR(finding->margin, -0.04, 0.006);
  EXPECT_EQ(finding->allowance, 0.03);
}

TEST(Check, PassesTheDemonstratorsProgramAsItWasRunAndNotWithoutItsCorrections) {
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  CheckOptions options;
  options.sequence = "1";
  const motion::Program program = motion::load_program(path);
  const CheckResult result = check_program(demonstrator(), corrected(demonstrator(), program, "seq1"), options);
  std::string errors;
  for (const CheckFinding& finding : result.findings) {
    if (finding.is_error)
      errors += finding.waypoint + ": " + finding.what + " " + std::to_string(finding.margin) + "\n";
  }
  EXPECT_TRUE(result.is_ok) << errors;
  EXPECT_GT(result.looks, 1000);
  EXPECT_NE(find(result.margins, CheckKind::JointLimit), nullptr);
  EXPECT_NE(find(result.margins, CheckKind::Singularity), nullptr);
  // Without them the turned box 016 is picked up 38 mm off (simulated, too: the cup misses it).
  const CheckResult off = check_program(demonstrator(), program, options);
  EXPECT_FALSE(off.is_ok);
  for (const CheckFinding& finding : off.findings) {
    if (!finding.is_error) continue;
    EXPECT_EQ(finding.what, "BOX016 - " + demonstrator().target) << finding.waypoint;
    EXPECT_NEAR(finding.margin, -0.0375, 0.004);
  }
}

TEST(Check, FindsARowOutOfReach) {
  const CheckResult result = check({row_at(home().p), row_at(home().p + Vector3(0.0, -3.0, 0.0))});
  EXPECT_FALSE(result.is_ok);
  const CheckFinding* finding = find(result.findings, CheckKind::Reach);
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->row, 1);
  EXPECT_LT(finding->margin, -1.0);
}

TEST(Check, FindsTheWallThatTheGripperRunsInto) {
  const CheckResult result = check(into_the_wall());
  EXPECT_FALSE(result.is_ok);
  const auto finding = std::find_if(result.findings.begin(), result.findings.end(), [](const CheckFinding& found) {
    return found.kind == CheckKind::Collision && found.what == "gripper - " + demonstrator().target;
  });
  ASSERT_NE(finding, result.findings.end());
  EXPECT_EQ(finding->row, 2);
  EXPECT_TRUE(finding->is_error);
  // The rod's axis ends 50 mm beyond the inner face of a wall 10 mm thick; radius 20 mm: it is through.
  EXPECT_LT(finding->margin, -0.005);
}

TEST(Check, FindsTheWallThatAWristRunsInto) {
  const CheckResult result = check(wrist_into_the_wall());
  const auto finding = std::find_if(result.findings.begin(), result.findings.end(), [](const CheckFinding& found) {
    return found.kind == CheckKind::Collision && found.what == "wrist_2_link - " + demonstrator().target;
  });
  ASSERT_NE(finding, result.findings.end());
  EXPECT_EQ(finding->row, 2);
  EXPECT_LT(finding->margin, 0.0);
}

TEST(Check, FindsTheSingularityOnTheWay) {
  // Wrist 2 is at a right angle at home; where it comes to zero the last axis is parallel to the fourth.
  const Simulation simulation(demonstrator(), "1", {motion::LaggedTracking{}, cup::CupMode::Holding, "ur10"});
  const auto turned_by = [&](double angle) {
    robot::JointVector q = simulation.arm()->start();
    q[4] -= angle;
    motion::Waypoint turned = row_at(home().p);
    turned.X_WE = robot::forward_tool(simulation.arm()->model(), q);
    return check({row_at(home().p), turned}, "");
  };
  const CheckResult before = turned_by(1.3);
  EXPECT_EQ(find(before.findings, CheckKind::Singularity), nullptr) << "0.27 rad before it";
  EXPECT_GT(find(before.margins, CheckKind::Singularity)->margin, 0.0);
  const CheckResult result = turned_by(1.7);
  EXPECT_FALSE(result.is_ok);
  const CheckFinding* finding = find(result.findings, CheckKind::Singularity);
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->row, 1);
}

TEST(Check, LooksAtTheHeldBox) {
  // The box of the first pick, carried low over the rim: gripper and cup pass, the box does not.
  const std::filesystem::path path = kSource / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  motion::Program program = motion::load_program(path);
  std::vector<motion::Waypoint> rows(program.waypoints.begin(), program.waypoints.begin() + 3);
  const model::Container& tote = *model::find_container(demonstrator(), demonstrator().target);
  const Vector3 rim = tote.X_WT * Vector3(0.0, 0.0, tote.inner_size.z());
  motion::Waypoint high = row_at(rim + Vector3(0.0, 0.0, 0.3), "PrePlace");
  motion::Waypoint over =
      row_at(tote.X_WT * Vector3(0.5 * tote.inner_size.x(), 0.0, tote.inner_size.z() + 0.08), "PrePlace");
  high.io.vacuum = over.io.vacuum = true;
  rows.push_back(high);
  rows.push_back(over);
  const CheckResult with_box = check(rows), without = check(rows, "");
  const auto hits_tote = [](const CheckResult& result) {
    return std::any_of(result.findings.begin(), result.findings.end(), [](const CheckFinding& finding) {
      return finding.kind == CheckKind::Collision && finding.what.find("BOX") == 0;
    });
  };
  EXPECT_TRUE(hits_tote(with_box));
  EXPECT_FALSE(hits_tote(without));
}

constexpr double kYawThere =
    -0.5 * std::numbers::pi;  ///< rad, of the tool over the container: the wrist has room there

/// The item picked at the aligner, and where asked let go over the middle of the container, one millimetre over its
/// floor.
std::vector<motion::Waypoint> pick(const model::Scenario& scenario, int item, bool is_placed) {
  const model::Sequence& sequence = scenario.sequences.front();
  const model::Item& fed = sequence.items[static_cast<std::size_t>(item)];
  const Pose X_WP = pose_at_aligner(scenario, fed, 0);
  const Vector3 half = 0.5 * (X_WP.R.cwiseAbs() * model::find_parcel(scenario, fed.parcel)->size);
  const double held = scenario.cup.hold_length;
  const auto row = [&](const std::string& word, const Vector3& p, bool vacuum, double yaw = std::numbers::pi) {
    return motion::named_waypoint(word + "(" + fed.parcel + ")", {motion::upright_tool(yaw), p}, {.vacuum = vacuum});
  };
  const Vector3 top = X_WP.p + Vector3(0.0, 0.0, half.z()), up(0.0, 0.0, 0.35);
  std::vector<motion::Waypoint> rows{row("PrePick", top + up, false), row("Box", top + Vector3(0.0, 0.0, held), false),
                                     row("PostPick", top + up, true)};
  if (!is_placed) return rows;
  const Vector3 place =
      model::find_container(scenario, scenario.target)->X_WT.p + Vector3(0.0, 0.0, 2.0 * half.z() + held + 0.001);
  rows.push_back(row("PrePlace", place + up, true, kYawThere));
  rows.push_back(row("Place", place, true, kYawThere));
  rows.push_back(row("Place", place, false, kYawThere));
  rows.push_back(row("PostPlace", place + up, false, kYawThere));
  return rows;
}

double least_hold(double mass_factor) {
  model::Scenario scenario = demonstrator();
  for (model::Parcel& parcel : scenario.parcels) {
    parcel.inertia.mass *= mass_factor;
    parcel.inertia.inertia *= mass_factor;
  }
  CheckOptions options;
  options.sequence = scenario.sequences.front().name;
  const CheckResult result = check_program(scenario, {"test", pick(scenario, 0, false)}, options);
  const CheckFinding* hold = find(result.margins, CheckKind::Hold);
  EXPECT_NE(hold, nullptr);
  if (hold == nullptr) return 0.0;
  EXPECT_EQ(result.is_ok, hold->margin > 0.0);
  EXPECT_EQ(find(result.findings, CheckKind::Hold) == nullptr, hold->margin > 0.0);
  return hold->margin + 1.0;
}

TEST(Check, TheHoldFallsWithTheMassOfTheBox) {
  const double one = least_hold(1.0);
  EXPECT_GT(one, 2.0);
  EXPECT_NEAR(least_hold(2.0), 0.5 * one, 1e-9 * one) << "of the same motion: forces are in proportion";
  EXPECT_LT(least_hold(2.0 * one), 1.0) << "it would be lost, and that is an error";
}

TEST(Check, TheHoldAtRestIsThatOfTheWeight) {
  const model::Scenario& scenario = demonstrator();
  const model::Parcel& parcel = *model::find_parcel(scenario, scenario.sequences.front().items.front().parcel);
  Wrench F_S;  // pulled straight down: at least that much of it is asked
  F_S.force.z() = -parcel.inertia.mass * scenario.gravity.norm();
  const double straight = cup::find_hold_factor(scenario.cup, scenario.cup.vacuum.pressure_gauge_hold, F_S);
  EXPECT_LT(least_hold(1.0), straight) << "its centre is beside the cup, and the tool accelerates";
  EXPECT_GT(least_hold(1.0), 0.1 * straight);
}

TEST(Check, SeesBoxesThatAreBroughtToTheSamePlace) {
  const model::Scenario& scenario = demonstrator();
  std::vector<motion::Waypoint> rows = pick(scenario, 0, true);
  const std::string first = scenario.sequences.front().items[0].parcel,
                    second = scenario.sequences.front().items[1].parcel;
  const auto collides = [&](const CheckResult& result) {
    return std::ranges::any_of(result.findings, [&](const CheckFinding& one) {
      return one.kind == CheckKind::Collision && one.what == second + " - " + first && one.is_error;
    });
  };
  EXPECT_FALSE(collides(check(rows)));
  for (motion::Waypoint& row : pick(scenario, 1, true)) rows.push_back(row);
  EXPECT_TRUE(collides(check(rows)));
  EXPECT_FALSE(collides(check(rows, ""))) << "boxes are not looked at";
}

}  // namespace
}  // namespace snug::runs
