// Tests of reading and writing programs.
#include "snug/motion/waypoint.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/motion/program_csv.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>

#include "snug/core/rng.hpp"
#include "snug/motion/test/demonstrator.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

constexpr const char* kRow = ".1, -.2, +0.3, 0, 3.14, 0,Box027,0,0,0,0,0,0";

std::string failing_place(const std::string& text) {
  return where_it_fails([&] { (void)parse_program(text, "f.csv"); });
}

/// kRow with column `column` (from 1) replaced.
std::string with_column(int column, const std::string& value) {
  std::string text = kRow;
  std::size_t begin = 0;
  for (int i = 1; i < column; ++i) begin = text.find(',', begin) + 1;
  return text.substr(0, begin) + value + text.substr(std::min(text.find(',', begin), text.size()));
}

TEST(Program, ReadsPoseNameSwitchesAndLine) {
  const Program program = parse_program("\n.1,-.2,+0.3,0,0,1.5707963267948966,Box027,1,0,1,0,1,0\n", "f.csv");
  ASSERT_EQ(program.waypoints.size(), 1u);
  const Waypoint& w = program.waypoints[0];
  EXPECT_EQ(w.X_WE.p, Vector3(0.1, -0.2, 0.3));
  EXPECT_LT((w.X_WE.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);  // rounding of sin and cos
  EXPECT_EQ(name_of(w), "Box027");
  EXPECT_EQ(w.io, (IO{true, false, true, false, true, false}));
  EXPECT_EQ(w.line, 2);
  EXPECT_EQ(place_of(program, 0), "f.csv:2");
}

TEST(Program, ToleratesCarriageReturnsBlankLinesSpacesAndMissingLastNewline) {
  const std::string messy =
      std::string("\xEF\xBB\xBF  \r\n\t") + kRow + " \r\n\r\n" + " .1 ,\t-.2, 0.3,0,3.14,0 , Box027 ,0,0,0,0,0, 0";
  const Program program = parse_program(messy, "f.csv");
  ASSERT_EQ(program.waypoints.size(), 2u);
  EXPECT_EQ(program.waypoints[0].line, 2);
  EXPECT_EQ(program.waypoints[1].line, 4);
  EXPECT_EQ(program.waypoints[0].X_WE, program.waypoints[1].X_WE);
  EXPECT_EQ(name_of(program.waypoints[0]), name_of(program.waypoints[1]));
}

TEST(Program, NamesFileLineAndColumnOfWhatItCannotUse) {
  const std::string good = std::string(kRow) + "\n";
  EXPECT_EQ(failing_place(good + with_column(3, "abc")), "f.csv:2 column 3 (z)");
  EXPECT_EQ(failing_place(good + with_column(1, "nan")), "f.csv:2 column 1 (x)");
  EXPECT_EQ(failing_place(good + with_column(4, "-inf")), "f.csv:2 column 4 (rx)");
  EXPECT_EQ(failing_place(good + with_column(2, "")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(2, "1.0.0")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(2, "+-1")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(2, "0x1p3")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(2, "1 2")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(2, "1e999")), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(good + with_column(1, "460")), "f.csv:2 column 1 (x)");
  EXPECT_EQ(failing_place(good + with_column(6, "180")), "f.csv:2 column 6 (rz)");
  EXPECT_EQ(failing_place(good + with_column(7, "  ")), "f.csv:2 column 7 (name)");
  EXPECT_EQ(failing_place(good + with_column(7, "a\x01z")), "f.csv:2 column 7 (name)");
  EXPECT_EQ(failing_place(good + with_column(8, "2")), "f.csv:2 column 8 (vacuum)");
  EXPECT_EQ(failing_place(good + with_column(9, "true")), "f.csv:2 column 9 (blow-off)");
  EXPECT_EQ(failing_place(good + with_column(13, "")), "f.csv:2 column 13 (reserved)");
  EXPECT_EQ(failing_place(good + kRow + ",0"), "f.csv:2 ");
  EXPECT_EQ(failing_place(good + ".1,.2"), "f.csv:2 ");
  EXPECT_EQ(failing_place(good + "x,y,z,rx,ry,rz,name,1,0,0,0,0,0"), "f.csv:2 column 1 (x)");
  EXPECT_EQ(failing_place(good + with_column(2, std::string("0\0", 2))), "f.csv:2 column 2 (y)");
  EXPECT_EQ(failing_place(""), "f.csv ");
  EXPECT_EQ(failing_place("\n \r\n"), "f.csv ");
}

TEST(Program, SaysWhatStoodThereAndWhatWasExpected) {
  try {
    (void)parse_program(with_column(8, "yes"), "f.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "f.csv:1: column 8 (vacuum): got 'yes'; expected 0 or 1");
  }
}

TEST(Program, NeverDoesAnythingButReadOrThrowOnGarbage) {
  Rng rng = Rng(7).split("garbage");
  const std::string alphabet = "0123456789.,+-eE \t\r\nBoxnaif\"#;\x00\xff";
  const std::string good = std::string(kRow) + "\n" + kRow + "\n";
  for (int i = 0; i < 20000; ++i) {
    std::string text = good;
    const int edits = 1 + rng.index(6);
    for (int e = 0; e < edits; ++e) {
      const std::size_t at = static_cast<std::size_t>(rng.index(static_cast<int>(text.size())));
      const char c = alphabet[static_cast<std::size_t>(rng.index(static_cast<int>(alphabet.size())))];
      if (rng.uniform() < 0.4) {
        text.erase(at, 1);
      } else if (rng.uniform() < 0.5) {
        text[at] = c;
      } else {
        text.insert(at, 1, c);
      }
    }
    try {
      for (const Waypoint& w : parse_program(text, "f.csv").waypoints) {
        ASSERT_TRUE(w.X_WE.p.allFinite() && w.X_WE.R.allFinite() && !name_of(w).empty()) << text;
      }
    } catch (const InputError& error) {
      ASSERT_TRUE(error.where.starts_with("f.csv")) << text;
    }
  }
}

/// The rows of the text, read and written again.
std::string rewritten(const std::string& text) { return format_program(parse_program(text, "f.csv")); }

TEST(Program, KeepsRotationVectorsOfFewDigitsAsTheyAreWritten) {
  for (const char* rotation : {"0, 0, 0", "0, 3.141593, 0", "-0.5, 0.25, 1.125", "0, 0, 1.5708", "2.2214, 2.2214, 0",
                               "1.234567, -0.7654321, 0.000123456789"}) {
    const std::string row = fmt::format("0.1, -0.2, 0.3, {},Box027,0,0,0,0,0,0\n", rotation);
    EXPECT_EQ(rewritten(row), row);
  }
}

TEST(Program, KeepsRotationsOfVectorsLongerThanPi) {
  const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized();
  for (const double angle : {0.0, 1e-13, 1.0, std::numbers::pi, 3.1416, 4.0, 2.0 * std::numbers::pi, 9.0}) {
    SCOPED_TRACE(angle);
    Program program = parse_program(kRow, "f.csv");
    program.waypoints[0].X_WE.R = exp_rotation(angle * axis);
    const Program again = parse_program(format_program(program), "f.csv");
    // Roundings of logarithm and exponential, where no vector gives the matrix back to the last bit.
    EXPECT_LT((again.waypoints[0].X_WE.R - program.waypoints[0].X_WE.R).norm(), 1e-14);
    EXPECT_EQ(format_program(again), rewritten(format_program(again)));
  }
}

TEST(Program, ComesBackFromItsTextToTheLastBitForRoundedPoses) {
  Rng rng = Rng(7).split("round trip");
  Program program{"f.csv", {}};
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WE = {exp_rotation(random_vector(rng, i % 2 == 1 ? 10.0 : 4.0)),
                       random_vector(rng, std::pow(10.0, rng.uniform(-12.0, 1.0)))};
    Waypoint w = rounded(named_waypoint("Box" + std::to_string(i), X_WE));
    w.io = {rng.index(2) == 1, rng.index(2) == 1, rng.index(2) == 1, rng.index(2) == 1, rng.index(2) == 1, false};
    w.line = i + 1;
    program.waypoints.push_back(w);
  }
  const Program again = parse_program(format_program(program), "f.csv");
  EXPECT_EQ(again.waypoints, program.waypoints);
}

TEST(Program, ComesBackFromItsTextToRoundingForAnyPose) {
  Rng rng = Rng(8).split("any pose");
  int exact = 0;
  for (int i = 0; i < 500; ++i) {
    const Program program{"f.csv", {named_waypoint("home", {exp_rotation(random_vector(rng, 1.7)), Vector3::Zero()})}};
    const Matrix3 R = parse_program(format_program(program), "f.csv").waypoints[0].X_WE.R;
    EXPECT_LT((R - program.waypoints[0].X_WE.R).norm(), 1e-14);
    exact += R == program.waypoints[0].X_WE.R ? 1 : 0;
  }
  EXPECT_GE(exact, 475) << "a vector that gives the matrix back is looked for, and found but near pi";
}

TEST(Waypoint, IsRoundedByHalfAStepOfItsRotationVector) {
  Rng rng(8);
  for (int i = 0; i < 2000; ++i) {
    Vector3 axis(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    const double angle = i % 3 == 0 ? std::numbers::pi : i % 3 == 1 ? rng.uniform(0.0, 3.1) : 0.5 * std::numbers::pi;
    if (i % 4 == 0) axis.z() = 0.0;  // tools that point straight down
    if (i % 20 == 0) axis.x() = 0.0;
    if (i % 28 == 0) axis.y() = 0.0;
    const Pose X_WE = {exp_rotation(angle * axis.normalized()), Vector3(0.1, -0.2, 1.0 / 3.0)};
    const Waypoint row = make_waypoint(MotionClass::Home, {}, X_WE);
    EXPECT_EQ(row.X_WE, X_WE);
    // Half of 2^-40 rad in each of three coordinates; the norm of the matrices' difference is sqrt(2) times as much.
    // The logarithm near pi costs 1e-13.
    const Waypoint coarse = rounded(row);
    EXPECT_EQ(coarse.X_WE.p, X_WE.p);
    EXPECT_LT((coarse.X_WE.R - X_WE.R).norm(), std::sqrt(3.0) * 0x1p-41 * std::numbers::sqrt2 + 1e-13);
    EXPECT_EQ(rounded(coarse), coarse);
    EXPECT_EQ(parse_program(format_program({"f.csv", {coarse}}), "f.csv").waypoints[0].X_WE, coarse.X_WE);
  }
}

TEST(Program, RefusesToWriteWhatCouldNotBeRead) {
  Program program = parse_program(kRow, "f.csv");
  program.waypoints[0].line = 0;
  for (const char* name : {"", "a,b", " a", "a\n"}) {
    program.waypoints[0] = parse_waypoint_name(name);
    EXPECT_EQ(where_it_fails([&] { (void)format_program(program); }), "f.csv row 1 column 7 (name)");
  }
  program.waypoints[0] = parse_waypoint_name("home");
  program.waypoints[0].X_WE.p.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(where_it_fails([&] { (void)format_program(program); }), "f.csv row 1 home");
}

TEST(Program, IsWrittenWholeAndLeavesNothingBeside) {
  const snug::test::ScratchFolder folder;
  const auto path = folder / "program.csv";
  std::ofstream(path) << "old";
  const Program program = parse_program(kRow, path.string());
  write_program(program, path);
  const Program again = load_program(path);
  ASSERT_EQ(again.waypoints.size(), 1u);
  EXPECT_EQ(again.waypoints[0], program.waypoints[0]);
  EXPECT_EQ(folder.names(), std::set<std::string>{"program.csv"});
  EXPECT_THROW(write_program(program, folder / "missing" / "program.csv"), InputError);
  EXPECT_THROW((void)load_program(folder / "missing.csv"), InputError);
  EXPECT_THROW((void)load_program(folder.path()), InputError);
}

TEST(Program, ReadsEveryFileOfTheDemonstrator) {
  SNUG_NEED_WAYPOINT_FILES();
  const std::vector<std::size_t> rows = {98, 98, 107, 107, 116, 116};  // interfaces: rows of sequences 1 to 3
  for (std::size_t i = 0; i < waypoint_files().size(); ++i) {
    SCOPED_TRACE(waypoint_files()[i]);
    const Program program = load_program(waypoint_folder() / waypoint_files()[i]);
    EXPECT_EQ(program.waypoints.size(), rows[i]);
    EXPECT_EQ(name_of(program.waypoints.back()), "home");
    const Program again = parse_program(format_program(program), program.name);
    for (std::size_t k = 0; k < rows[i]; ++k) {
      Waypoint read = again.waypoints[k];
      read.line = program.waypoints[k].line;
      EXPECT_EQ(read, program.waypoints[k]) << k;
    }
  }
}

}  // namespace
}  // namespace snug::motion
