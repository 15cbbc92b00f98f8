// CSV: names, order, numbers and signs of the table.
#include "snug/record/csv.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/record/test/random_recording.hpp"

namespace snug::record {
namespace {

using test::ScratchFolder;

struct ParsedTable {
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ';')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

ParsedTable parse(const std::filesystem::path& path) {
  std::ifstream file(path);
  ParsedTable table;
  std::string line;
  std::getline(file, line);
  table.names = split(line);
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line);
    EXPECT_EQ(cells.size(), table.names.size());
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < std::min(cells.size(), table.names.size()); ++i) row[table.names[i]] = cells[i];
    table.rows.push_back(row);
  }
  return table;
}

double number(const std::map<std::string, std::string>& row, const std::string& name) {
  EXPECT_TRUE(row.contains(name)) << name;
  return row.contains(name) ? std::strtod(row.at(name).c_str(), nullptr) : std::nan("");
}

Vector3 vector(const std::map<std::string, std::string>& row, const std::string& prefix, const std::string& x,
               const std::string& y, const std::string& z) {
  return {number(row, prefix + x), number(row, prefix + y), number(row, prefix + z)};
}

PoseSample logged_pose(const std::map<std::string, std::string>& row, const std::string& prefix) {
  const Vector3 p = vector(row, prefix, "_position_x", "_position_y", "_position_z");
  const std::string q = prefix + "_orientation_";
  return {p, Quaternion(number(row, q + "w"), number(row, q + "x"), number(row, q + "y"), number(row, q + "z"))};
}

class Csv : public ::testing::Test {
 protected:
  void SetUp() override {
    recording = test::random_recording(rng, 4, 50, 0);
    recording.header.bodies[0].kind = BodyKind::Dynamic;
    recording.header.bodies[1].kind = BodyKind::Static;
    recording.header.bodies[2].kind = BodyKind::Kinematic;
    recording.header.bodies[3].kind = BodyKind::Dynamic;
  }
  ParsedTable written() {
    write_csv(recording, folder / "run.csv");
    return parse(folder / "run.csv");
  }
  Rng rng = Rng(41).split("csv");
  ScratchFolder folder;
  Recording recording;
};

TEST_F(Csv, StartsWithTimeAndUsesMcRtcNames) {
  const ParsedTable table = written();
  ASSERT_FALSE(table.names.empty());
  EXPECT_EQ(table.names[0], "t");
  std::map<std::string, int> count;
  for (const std::string& name : table.names) ++count[name];
  for (const auto& [name, n] : count) EXPECT_EQ(n, 1) << name;
  for (const char* name : {"box010_FloatingBase_position_x", "box010_FloatingBase_orientation_w",
                           "box013_FloatingBase_position_z", "tote1_FloatingBase_position_y", "UR10FTSensor_cx",
                           "UR10FTSensor_fz", "vacuum", "pressure_gauge", "cup_length", "cup_bend"})
    EXPECT_TRUE(count.contains(name)) << name;
  EXPECT_FALSE(count.contains("box011_FloatingBase_position_x")) << "static bodies have no columns";
  const auto at = [&](const char* name) { return std::find(table.names.begin(), table.names.end(), name); };
  EXPECT_LT(at("UR10FTSensor_cz"), at("UR10FTSensor_fx")) << "couple first";
}

TEST_F(Csv, HasStrictlyIncreasingTime) {
  const ParsedTable table = written();
  ASSERT_EQ(table.rows.size(), recording.frames.size());
  double last = -1.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double t = number(table.rows[i], "t");
    EXPECT_GT(t, last);
    EXPECT_EQ(t, recording.frames[i].time);
    last = t;
  }
}

TEST_F(Csv, KeepsNumbersExactlyAndInvertsRotations) {
  const ParsedTable table = written();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& row = table.rows[i];
    const Frame& frame = recording.frames[i];
    const PoseSample box = logged_pose(row, "box013_FloatingBase");
    EXPECT_EQ(box.p, frame.bodies[3].X_WB.p);
    // world -> body times body -> world is the identity; 1e-15 is a few roundings of a product of unit quaternions.
    const Matrix3 product = box.quat.toRotationMatrix() * frame.bodies[3].X_WB.quat.toRotationMatrix();
    EXPECT_LT((product - Matrix3::Identity()).norm(), 5e-15);
    EXPECT_EQ(vector(row, "UR10FTSensor_", "fx", "fy", "fz"), frame.F_flange.force);
    EXPECT_EQ(vector(row, "UR10FTSensor_", "cx", "cy", "cz"), frame.F_flange.torque);
    EXPECT_EQ(vector(row, "cup_wrench_", "fx", "fy", "fz"), frame.cup.F_PSo_S.force);
    EXPECT_EQ(vector(row, "tool_velocity_", "vx", "vy", "vz"), frame.V_WE.linear);
    EXPECT_EQ(number(row, "pressure_gauge"), frame.cup.pressure_gauge);
    EXPECT_EQ(number(row, "vacuum"), frame.cup.vacuum_command ? 1.0 : 0.0);
    EXPECT_EQ(logged_pose(row, "tool_command").p, frame.X_WE_command.p);
    EXPECT_EQ(row.at("cup_attached").empty(), frame.cup.attached_body < 0);
  }
}

TEST_F(Csv, GivesTheKnownSignOfAQuarterTurn) {
  // Body turned by +90 degrees about z: quat_WB = (c, 0, 0, s); logged world -> body: (c, 0, 0, -s).
  recording.frames.resize(1);
  recording.frames[0].bodies[0].X_WB.quat = Quaternion(Eigen::AngleAxisd(0.5 * 3.14159265358979, Vector3::UnitZ()));
  const PoseSample box = logged_pose(written().rows.at(0), "box010_FloatingBase");
  EXPECT_NEAR(box.quat.w(), 0.70710678118, 1e-10);  // digits given
  EXPECT_NEAR(box.quat.z(), -0.70710678118, 1e-10);
}

TEST_F(Csv, KeepsQuaternionsContinuousThroughHalfATurn) {
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const double angle = 3.0 + 0.01 * static_cast<double>(i);
    recording.frames[i].X_WE = Pose{Eigen::AngleAxisd(angle, Vector3::UnitX()).toRotationMatrix(), Vector3::Zero()};
  }
  const ParsedTable table = written();
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    const Quaternion before = logged_pose(table.rows[i - 1], "tool").quat;
    const Quaternion after = logged_pose(table.rows[i], "tool").quat;
    // 0.01 rad moves a quaternion by 0.005.
    EXPECT_NEAR((after.coeffs() - before.coeffs()).norm(), 0.005, 1e-6) << i;
  }
}

TEST_F(Csv, LeavesCellsEmptyForMissingValues) {
  recording.frames[3].bodies[0].present = false;
  recording.frames[4].cup.pressure_gauge = std::nan("");
  recording.frames[5].cup.length = std::numeric_limits<double>::infinity();
  const ParsedTable table = written();
  EXPECT_EQ(table.rows[3].at("box010_FloatingBase_position_x"), "");
  EXPECT_EQ(table.rows[3].at("box010_FloatingBase_orientation_w"), "");
  EXPECT_NE(table.rows[2].at("box010_FloatingBase_position_x"), "");
  EXPECT_EQ(table.rows[4].at("pressure_gauge"), "");
  EXPECT_EQ(table.rows[5].at("cup_length"), "");
}

TEST_F(Csv, KeepsHugeAndTinyNumbers) {
  recording.frames[0].F_flange.force = {std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min(),
                                        -0.1};
  EXPECT_EQ(vector(written().rows[0], "UR10FTSensor_", "fx", "fy", "fz"), recording.frames[0].F_flange.force);
}

TEST_F(Csv, ReplacesTheTableWholeAndLeavesNothingBeside) {
  std::ofstream(folder / "run.csv") << "old";
  (void)written();
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "")) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 1);
}

TEST_F(Csv, ThrowsWhenItCannotWrite) {
  EXPECT_THROW(write_csv(recording, folder / "no/such/run.csv"), InputError);
  EXPECT_THROW(write_csv(recording, folder / ""), InputError);
}

TEST_F(Csv, KeepsNamesFromBreakingTheTable) {
  recording.header.bodies[0].name = "big; \"red\" box";
  const ParsedTable table = written();
  EXPECT_NE(std::find(table.names.begin(), table.names.end(), "big___red__box_FloatingBase_position_x"),
            table.names.end());
}

TEST_F(Csv, HasNoCellThatASpreadsheetWouldRun) {
  const char* names[] = {"=cmd|' /C calc'!A0", "+1", "-2+3", "@SUM(1)"};
  for (std::size_t i = 0; i < 4; ++i) {
    recording.header.bodies[i].name = names[i];
    recording.header.bodies[i].kind = BodyKind::Dynamic;
    recording.frames[i].cup.attached_body = static_cast<int>(i);
  }
  recording.header.container.name = "\t=1";
  const ParsedTable table = written();
  for (const std::string& name : table.names)
    EXPECT_EQ(std::string("=+-@\t\r").find(name[0]), std::string::npos) << name;
  EXPECT_EQ(table.rows[2].at("cup_attached"), "_2+3");
  for (const auto& row : table.rows) {
    for (const auto& [name, text] : row) {
      if (text.empty() || name == "cup_attached") continue;
      EXPECT_EQ(text.find_first_not_of("0123456789+-.e"), std::string::npos) << name << ": numbers stay numbers";
    }
  }
  EXPECT_LT(number(table.rows[0], "tool_position_x") * number(table.rows[0], "tool_position_x"), 4.01);
}

}  // namespace
}  // namespace snug::record
