// robot.io: how gripper and cell are wired, as scenarios say it, and what is refused.
#include "snug/model/robot_io.hpp"

#include <gtest/gtest.h>

#include "scenario_text.hpp"
#include "snug/model/scenario_edit.hpp"

namespace snug::model {
namespace {

using test::expect_complaint;

std::string scenario_with(const std::string& io) {
  return "name: wired\nmaterials: [{name: m}]\nrobot:\n  urdf: a.urdf\n  posture: [0.0]\n  io:\n" + io;
}

RobotIo io_of(const std::string& io) { return robot_io(parse_scenario(scenario_with(io), "test.yaml")); }

TEST(RobotIo, IsWiredAsServedCellsAreUnlessSaid) {
  const RobotIo io = robot_io(test::demonstrator());
  EXPECT_EQ(io, RobotIo{});
  EXPECT_EQ(io.vacuum.bit(), 0);
  EXPECT_EQ(io.blow_off->bit(), 1);
  EXPECT_EQ(io.vacuum_reached->bit(), 0);
  EXPECT_EQ(io.part_present->bit(), 1);
  EXPECT_EQ(io.next_part->bit(), 2);
  EXPECT_EQ(io.vacuum_gauge->pressure_of(6.0), -6e4);
}

TEST(RobotIo, TakesKindNumberAndPolarity) {
  const RobotIo io = io_of(
      "    vacuum: {kind: tool, number: 1, active_low: true}\n"
      "    blow_off: none\n"
      "    vacuum_reached: {kind: configurable, number: 7}\n"
      "    part_present: {active_low: true}\n"
      "    vacuum_gauge: {kind: standard, number: 1, at_ambient: 1, at_vacuum: 5, pressure_gauge: -1.0e+5}\n");
  EXPECT_EQ(io.vacuum, (DigitalIo{DigitalKind::Tool, 1, true}));
  EXPECT_EQ(io.vacuum.bit(), 17);
  EXPECT_EQ(io.blow_off, std::nullopt);
  EXPECT_EQ(io.vacuum_reached->bit(), 15);
  EXPECT_EQ(io.part_present, (DigitalIo{DigitalKind::Standard, 1, true})) << "the number of its default";
  ASSERT_TRUE(io.vacuum_gauge);
  EXPECT_EQ(io.vacuum_gauge->kind, AnalogKind::Standard);
  EXPECT_DOUBLE_EQ(io.vacuum_gauge->pressure_of(3.0), -5e4);
  EXPECT_DOUBLE_EQ(io.vacuum_gauge->reading_of(-5e4), 3.0);
  EXPECT_EQ(io_of("    vacuum_gauge: none\n").vacuum_gauge, std::nullopt);
}

TEST(RobotIo, IsSetByKeyAndWrittenBack) {
  const Scenario changed = with_values(test::demonstrator(), {{"robot.io.vacuum.number", "5"}}, "--set");
  EXPECT_EQ(robot_io(changed).vacuum.number, 5);
  EXPECT_EQ(changed, parse_scenario(changed.source_text, changed.source_name));
}

TEST(RobotIo, RefusesWhatCannotBe) {
  expect_complaint(scenario_with("    vacum: {number: 1}\n"), {"vacum", "robot.io.vacum", "", "'vacuum' (nearest)"});
  expect_complaint(scenario_with("    vacuum: none\n"), {"vacuum: none", "robot.io.vacuum", "none", "mapping"});
  expect_complaint(scenario_with("    blow_off: nothing\n"), {"nothing", "robot.io.blow_off", "nothing", "none"});
  expect_complaint(scenario_with("    vacuum: {kind: standart}\n"),
                   {"standart", "robot.io.vacuum.kind", "standart", "nearest is 'standard'"});
  expect_complaint(scenario_with("    vacuum: {number: 8}\n"), {"8", "robot.io.vacuum.number", "8", "7"});
  expect_complaint(scenario_with("    vacuum: {kind: tool, number: 2}\n"),
                   {"kind: tool", "robot.io.vacuum", "number 2", "0 or 1"});
  expect_complaint(scenario_with("    vacuum: {number: 1}\n"), {"number: 1", "robot.io.vacuum", "blow_off", "its own"});
  expect_complaint(scenario_with("    blow_off: {number: 2}\n"),
                   {"number: 2", "robot.io.blow_off", "next_part", "its own"});
  expect_complaint(scenario_with("    part_present: {number: 0}\n"),
                   {"part_present", "robot.io.part_present", "vacuum_reached", "its own"});
  expect_complaint(scenario_with("    vacuum_gauge: {at_ambient: 5, at_vacuum: 5}\n"),
                   {"vacuum_gauge", "robot.io.vacuum_gauge", "at_ambient", "differ"});
  expect_complaint(scenario_with("    vacuum_gauge: {pressure_gauge: 0}\n"),
                   {"vacuum_gauge", "robot.io.vacuum_gauge.pressure_gauge", "0", "vacuum"});
}

}  // namespace
}  // namespace snug::model
