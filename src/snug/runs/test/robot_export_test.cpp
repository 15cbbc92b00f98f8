// RobotExport: what is written for a robot has been tried in its cell.
#include "snug/runs/robot_export.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/model/robot_io.hpp"
#include "snug/runs/test/robot_rows.hpp"

namespace snug::runs {
namespace {

/// Down by 0.1 m and up again, before the robot.
motion::Program hover() {
  const Vector3 low = test::home().p - Vector3(0.0, 0.0, 0.1);
  return {"hover", {test::row_at(test::home().p), test::row_at(low), test::row_at(test::home().p)}};
}

/// The same with a vacuum that finds nothing.
motion::Program grasp_at_nothing() {
  motion::Program program = hover();
  program.waypoints[1].io.vacuum = true;
  return program;
}

/// As the command line has it when a file says nothing of its motion.
cell::SimulationOptions lagged() { return {.tracking = motion::LaggedTracking{}}; }

RobotExport export_of(const motion::Program& program, RobotExportSettings settings) {
  return {cell::demonstrator(), "1", program, lagged(), std::move(settings)};
}

control::UrScriptOptions wired() {
  control::UrScriptOptions script;
  script.io = model::robot_io(cell::demonstrator());
  return script;
}

TEST(RobotExport, WritesAProgramThatSucceedsWithNotesOfWhatItIs) {
  const RobotExport program = export_of(hover(), {.program_name = "one.csv", .version = "1.2"});
  const RobotText moves = program.urscript(wired(), "");
  EXPECT_EQ(moves.refusal, "");
  EXPECT_NE(moves.text.find("program one.csv, 3 waypoints"), std::string::npos) << moves.text.substr(0, 400);
  EXPECT_NE(moves.summary.find(" moves, "), std::string::npos) << moves.summary;
  for (const RobotText& run : {program.ros_trajectory(0.04), program.log_csv(), program.log_flat()}) {
    EXPECT_EQ(run.refusal, "");
    EXPECT_EQ(run.summary.find("3 waypoints, "), 0U) << run.summary;
    EXPECT_NE(run.text, "");
  }
}

TEST(RobotExport, RefusesAProgramThatFailsUnlessItIsUnchecked) {
  const RobotText refused = export_of(grasp_at_nothing(), {}).ros_trajectory(0.04);
  EXPECT_EQ(refused.refusal.find("not exported: it does not succeed in the simulated cell: no seal toward "), 0U)
      << refused.refusal;
  EXPECT_EQ(refused.text, "");
  const RobotText unchecked = export_of(grasp_at_nothing(), {.is_unchecked = true}).ros_trajectory(0.04);
  EXPECT_EQ(unchecked.refusal, "");
  EXPECT_NE(unchecked.text, "");
}

TEST(RobotExport, WarnsOfALoadThatItsNamesDoNotTellAndBeginsWithNoBoxThatItDoesNotPick) {
  std::vector<std::string> warnings;
  const RobotExport program = export_of(
      grasp_at_nothing(), {.is_unchecked = true, .warn = [&](const std::string& text) { warnings.push_back(text); }});
  (void)program.urscript(wired(), "");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("no known box of sequence 1 is held"), std::string::npos) << warnings[0];
  EXPECT_THROW((void)program.urscript(wired(), "BOX999"), InputError);
}

TEST(RobotExport, NeedsARobot) {
  model::Scenario scenario = cell::demonstrator();
  scenario.robot.reset();
  EXPECT_THROW(RobotExport(scenario, "1", hover(), lagged(), {}), InputError);
}

TEST(StandardWiring, StandsInThePlaceOfTheScenarioAndIsNotTheSameTwice) {
  const model::RobotIo io = with_wiring({}, {.vacuum_output = 3, .blow_off_output = 4, .part_input = 5});
  EXPECT_EQ(io.vacuum.number, 3);
  EXPECT_EQ(io.blow_off->number, 4);
  EXPECT_EQ(io.part_present->number, 5);
  EXPECT_THROW((void)with_wiring({}, {.vacuum_output = 2, .blow_off_output = 2}), InputError);
  EXPECT_THROW((void)with_wiring({}, {.vacuum_input = 1, .part_input = 1}), InputError);
}

}  // namespace
}  // namespace snug::runs
