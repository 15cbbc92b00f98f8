// Tables of RTDE: separators, the tool, the force sensor, and slips.
#include <gtest/gtest.h>

#include "refusals.hpp"
#include "snug/archive_import/internal/readers.hpp"

namespace snug::archive_import::internal {
namespace {

using test::expect_refusal;

const std::string kHead =
    "timestamp actual_q_0 actual_digital_output_bits actual_TCP_pose_0 actual_TCP_pose_1 actual_TCP_pose_2 "
    "actual_TCP_pose_3 actual_TCP_pose_4 actual_TCP_pose_5 ft_raw_wrench_0 ft_raw_wrench_1 ft_raw_wrench_2 "
    "ft_raw_wrench_3 ft_raw_wrench_4 ft_raw_wrench_5\r\n";
const std::string kRows =
    "100.002 -1.5 3 0.1 0.2 0.3 0 0 1.5707963267948966 1 2 -3 0.1 0.2 0.3\r\n"
    "100.004 -1.6 1 0.1 0.2 0.4 0 0 0 1 2 -4 0.1 0.2 0.3\r\n";

TEST(Rtde, ColumnsStayAndTheToolIsItsPoseInBase) {
  for (const char separator : {' ', ',', ';', '\t'}) {
    SCOPED_TRACE(separator);
    std::string text = kHead + kRows;
    std::replace(text.begin(), text.end(), ' ', separator);
    ASSERT_TRUE(is_rtde(text));
    const record::RobotLog robot = read_rtde(text, "robot.csv", {}).recording.robot;
    EXPECT_EQ(robot.times, (std::vector<double>{100.002, 100.004}));
    ASSERT_EQ(robot.names.size(), 14U);
    EXPECT_EQ(robot.names[1], "actual_digital_output_bits");
    EXPECT_EQ(robot.columns[1], (std::vector<double>{3.0, 1.0}));
    ASSERT_EQ(robot.tool.size(), 2U);
    EXPECT_LT((robot.tool[0].p - Vector3(0.1, 0.2, 0.3)).norm(), 1e-15);
    EXPECT_LT(angle_between(robot.tool[0].pose().R, exp_rotation(Vector3(0, 0, M_PI / 2))), 1e-9);
  }
}

TEST(Rtde, TheForceSensorIsTakenOnlyWhenAskedFor) {
  const Imported without = read_rtde(kHead + kRows, "robot.csv", {});
  EXPECT_TRUE(without.recording.force_torque.times.empty());
  EXPECT_NE(without.remarks.back().find("--wrench"), std::string::npos);
  Hints hints;
  hints.wrench = "ft_raw_wrench";
  hints.turns_wrench = true;
  const record::WrenchLog log = read_rtde(kHead + kRows, "robot.csv", hints).recording.force_torque;
  EXPECT_EQ(log.wrenches.at(1).force, Vector3(-1, -2, 4));
  EXPECT_EQ(log.wrenches.at(1).torque, Vector3(-0.1, -0.2, -0.3));
}

TEST(Rtde, SlipsAreRefusedWithLineAndColumn) {
  const struct {
    std::string text, part;
  } slips[] = {
      {kHead, "0 rows"},
      {"timestamp\n1\n2\n", "one column"},
      {"timestamp q\n1 2\n1.5 x\n", "robot.csv:3: q"},
      {"timestamp q\n1 2\n0.5 2\n", "times that grow"},
      {"timestamp q\n1 2\n1.5\n", "1 cells"},
      {"timestamp q q\n1 2 3\n", "twice"},
      {"timestamp q\n1 2\nnan 3\n", "a time in s"},
      {"timestamp q\n1 2\n1e999 3\n", "a number"},
  };
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.part);
    expect_refusal([&] { return read_rtde(slip.text, "robot.csv", {}); }, slip.part);
  }
  Hints hints;
  hints.wrench = "ft_raw_wench";
  expect_refusal([&] { return read_rtde(kHead + kRows, "robot.csv", hints); }, "_0 to _5");
  const Imported twice = read_rtde("timestamp q\n1 2\n1 2\n1.5 3\n", "robot.csv", {});
  EXPECT_EQ(twice.recording.robot.times.size(), 2U) << "a package written twice counts once";
  EXPECT_FALSE(twice.remarks.empty());
}

}  // namespace
}  // namespace snug::archive_import::internal
