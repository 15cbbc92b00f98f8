// Tables of RTDE: separators, the tool, the force sensor, and slips.
#include <gtest/gtest.h>

#include <cmath>

#include "mutants.hpp"
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
      {kHead, "no row"},
      {"timestamp q\n1 2\n", "one row"},
      {"timestamp\n1\n2\n", "one column"},
      {"timestamp q\n1 2\n1.5 x\n", "robot.csv:3: q"},
      {"timestamp q\n1 2\n0.5 2\n", "times that grow"},
      {"timestamp q\n1 2\n1.5\n", "1 cells"},
      {"timestamp q q\n1 2 2\n2 2 3\n", "robot.csv:3: q: got the column twice, with 2 and 3"},
      {"timestamp q q\n1 2 nan\n", "twice, with 2 and nan"},
      {"timestamp timestamp\n1 1\n", "no column beside the time"},
      {"actual_q_0 q\n1 2\n", "--rate HZ"},
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

TEST(Rtde, ColumnsThatAreThereTwiceCountOnce) {
  const Imported imported =
      read_rtde("timestamp,target_current_0,actual_q_0,target_current_0\n1,2,3,2\n2,nan,4,\n", "robot.csv", {});
  const record::RobotLog& robot = imported.recording.robot;
  EXPECT_EQ(robot.names, (std::vector<std::string>{"target_current_0", "actual_q_0"}));
  EXPECT_EQ(robot.columns[1], (std::vector<double>{3.0, 4.0}));
  EXPECT_NE(imported.remarks.front().find("taken once: target_current_0"), std::string::npos);
}

TEST(Rtde, RowsWithoutTimesComeAtARateThatIsSaid) {
  const std::string text = "actual_q_0 actual_q_1\n0.1 0.2\n0.3 0.4\n0.5 0.6\n";
  ASSERT_TRUE(is_rtde(text));
  EXPECT_FALSE(is_rtde("t;actual_q_0\n0;1\n")) << "a log of mc_rtc, or a table of an archive";
  Hints hints;
  hints.rate = 125.0;
  const Imported imported = read_rtde(text, "robot.csv", hints);
  EXPECT_EQ(imported.recording.robot.times, (std::vector<double>{0.0, 0.008, 0.016}));
  EXPECT_EQ(imported.recording.robot.names.size(), 2U);
  EXPECT_NE(imported.remarks.front().find("125 rows a second"), std::string::npos);
  const Imported with_times = read_rtde("timestamp q\n1 2\n2 3\n", "robot.csv", hints);
  EXPECT_EQ(with_times.recording.robot.times, (std::vector<double>{1.0, 2.0}));
  EXPECT_NE(with_times.remarks.front().find("does not count"), std::string::npos);
  for (const double bad : {-1.0, 1e9, std::nan("")}) {
    hints.rate = bad;
    expect_refusal([&] { return read_rtde(text, "robot.csv", hints); }, "--rate");
  }
}

TEST(Rtde, RowsOfOneTimeAreCounted) {
  const Imported imported = read_rtde("timestamp q\n1 2\n1 2\n1 5\n1.5 3\n", "robot.csv", {});
  EXPECT_EQ(imported.recording.robot.columns[0], (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(imported.remarks.front(), "rows with the time of the row before are left out: 2; with other numbers: 1");
}

TEST(Rtde, MutantsAreReadOrRefused) {
  const std::vector<std::string> words = {"1e999", "-1", " ", ",", "\n", "\"", "nan", "timestamp", "t", "\xff", "True"};
  const auto read = [](const std::string& text) {
    Hints hints;
    hints.rate = 500.0;
    (void)read_rtde(text, "robot.csv", hints);
  };
  EXPECT_GT(test::expect_answers(kHead + kRows, words, 2500, read), 0);
  EXPECT_GT(test::expect_answers("actual_q_0 q actual_q_0 v\n1 2 1 3\n2 3 2 4\n5 6 5 7\n", words, 2500, read), 0);
}

}  // namespace
}  // namespace snug::archive_import::internal
