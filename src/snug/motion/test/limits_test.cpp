// Tests of choosing limits by a waypoint's name.
#include "snug/motion/limits.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "snug/motion/program_csv.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

std::string matching_prefix(const std::string& name) {
  const std::vector<NamedLimits> table = demonstrator_limits();
  const NamedLimits* entry = match_limits(name, table);
  return entry ? entry->prefix : "none";
}

TEST(Limits, OfTheLastMatchingPrefixCount) {
  EXPECT_EQ(matching_prefix("PrePlace017"), "PrePlace");
  EXPECT_EQ(matching_prefix("PrePlace018"), "PrePlace018");
  EXPECT_EQ(matching_prefix("PrePlace018_2"), "PrePlace018");
  EXPECT_EQ(matching_prefix("PrePlaceBox018"), "PrePlace");
  EXPECT_EQ(matching_prefix("PrePlace017_seq3"), "PrePlace017_seq3");
  EXPECT_EQ(matching_prefix("PostPickBox017"), "PostPick");
  EXPECT_EQ(matching_prefix("PlaceBox014"), "Place");
  EXPECT_EQ(matching_prefix("PreRepick016_2"), "PreRepick");
  EXPECT_EQ(matching_prefix("RePick016"), "RePick");
  EXPECT_EQ(matching_prefix("home"), "home");
}

TEST(Limits, AreNotFoundInTheMiddleOfANameOrInOtherLetters) {
  EXPECT_EQ(matching_prefix("MyBox017"), "none");
  EXPECT_EQ(matching_prefix("box017"), "none");
  EXPECT_EQ(matching_prefix("Repick016"), "none");
  EXPECT_EQ(matching_prefix(""), "none");
}

TEST(Limits, OfAnUnknownNameAreAnErrorWithLineKnownPrefixesAndTheNearest) {
  const Program program = parse_program("0,0,0,0,0,0,home,0,0,0,0,0,0\n0,0,0,0,0,0,PrePlcae012,0,0,0,0,0,0", "f.csv");
  const std::vector<NamedLimits> table = demonstrator_limits();
  EXPECT_EQ(find_limits(program, 0, table).max_turn_acceleration, 0.5);
  try {
    (void)find_limits(program, 1, table);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "f.csv:2");
    EXPECT_EQ(error.got, "PrePlcae012");
    EXPECT_NE(error.expected.find("PrePick, Box, PostPick"), std::string::npos) << error.expected;
    EXPECT_NE(error.expected.find("nearest: PrePlace"), std::string::npos) << error.expected;
  }
  EXPECT_THROW((void)find_limits(program, 0, {}), InputError);
}

TEST(Limits, ThatNoMotionCanHaveAreAnErrorNamingPrefixAndKey) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinity, -infinity, 1e-300, 1e300}) {
    SCOPED_TRACE(bad);
    std::vector<NamedLimits> table = demonstrator_limits();
    check_limits(table, "s.yaml");
    table[2].limits.max_turn_speed = bad;
    EXPECT_EQ(where_it_fails([&] { check_limits(table, "s.yaml"); }), "s.yaml limits of PostPick: max_turn_speed");
  }
}

TEST(Limits, OfTheDemonstratorCoverEveryRowOfItsFiles) {
  SNUG_NEED_WAYPOINT_FILES();
  const std::vector<NamedLimits> table = demonstrator_limits();
  for (const std::string& file : waypoint_files()) {
    const Program program = load_program(waypoint_folder() / file);
    for (std::size_t row = 0; row < program.waypoints.size(); ++row) {
      EXPECT_NO_THROW((void)find_limits(program, row, table)) << file << " row " << row;
    }
  }
}

}  // namespace
}  // namespace snug::motion
