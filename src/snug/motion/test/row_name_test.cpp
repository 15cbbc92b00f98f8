// RowName: whole ids of any form come back from the names of our own rows; numbers are those of the demonstrator.
#include "snug/motion/row_name.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "snug/motion/limits.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

TEST(RowName, IsForItsBoxAloneWhateverTheIdsAreLike) {
  // Ids that are parts of each other, look like numbers, suffixes or names of rows, or hold brackets and blanks.
  const std::vector<std::string> ids{"1",       "11",         "BOX11",    "BOX1",    "BOX011", "Box11", "A12B",
                                     "crate",   "crate_turn", "_2",       "(",       ")",      "a)b",   "(a)",
                                     "a)_turn", "Slow",       "Box",      "PrePick", "a b ",   "ü/√ 1", "018",
                                     "BOX018",  "Box(1)",     "ITEM0001", "a_2",     "a",      "a_"};
  Program program{"p.csv", {}};
  std::vector<std::string> meant;
  for (const std::string& id : ids) {
    for (const char* suffix : {"", "_2", "_turn", "_turn_around"}) {
      program.waypoints.push_back({Pose{}, row_name("PrePick", id, suffix), {}, 0});
      meant.push_back(id);
    }
  }
  const Program read = parse_program(format_program(program), "p.csv");
  ASSERT_EQ(read.waypoints.size(), meant.size());
  for (std::size_t i = 0; i < meant.size(); ++i) {
    const std::string& row = read.waypoints[i].name;
    SCOPED_TRACE(row);
    for (const std::string& id : ids) EXPECT_EQ(names_box(row, "PrePick", id) > 0, id == meant[i]) << id;
    EXPECT_EQ(names_box(row, "Box", meant[i]), 0U);
  }
}

TEST(RowName, OfTheDemonstratorNamesTheBoxOfThatNumber) {
  for (const char* row : {"PrePick027", "PrePick027_seq3", "PrePick_027", "PrePickBox027", "PrePickBOX027"}) {
    EXPECT_GT(names_box(row, "PrePick", "BOX027"), 0U) << row;
    EXPECT_EQ(names_box(row, "PrePick", "BOX0027"), 0U) << row;
    EXPECT_EQ(names_box(row, "PrePick", "BOX7"), 0U) << row;
    EXPECT_EQ(names_box(row, "PrePick", "B027"), 0U) << row;
  }
  EXPECT_EQ(names_box("PrePick1", "PrePick", "BOX11"), 0U);
  EXPECT_EQ(names_box("PrePick0271", "PrePick", "BOX027"), 0U);
  EXPECT_EQ(names_box("PrePick", "PrePick", "BOX027"), 0U);
  EXPECT_EQ(names_box("", "PrePick", "BOX027"), 0U);
  EXPECT_EQ(names_box("PrePick(BOX027", "PrePick", "BOX027"), 0U);
}

TEST(RowName, WrittenBareByHandIsForTheLongestIdAndWholeIdsBeforeNumbers) {
  EXPECT_GT(names_box("PrePickA12B", "PrePick", "A12B"), 0U);
  EXPECT_GT(names_box("PrePickcrate_2", "PrePick", "crate_2"), names_box("PrePickcrate_2", "PrePick", "crate"));
  EXPECT_EQ(names_box("PrePickcrates", "PrePick", "crate"), 0U);
  EXPECT_GT(names_box("PrePick027", "PrePick", "027"), names_box("PrePick027", "PrePick", "BOX027"));
}

TEST(RowName, SaysHowTheBoxOnTheWaySwings) {
  const Swing swing{0.42, 0.31};
  const std::string name = with_swing(row_name("PrePlace", "BOX027"), swing);
  EXPECT_EQ(name, "PrePlace(BOX027)~0.42+0.31");
  EXPECT_EQ(swing_of(name), swing);
  EXPECT_EQ(swing_of(name + "_turn"), swing) << "rows in between are named after it";
  EXPECT_GT(names_box(name, "PrePlace", "BOX027"), 0U);
  EXPECT_EQ(with_swing("a", {0.1234, 1.0}), "a~0.12+1.00");
  const Program read = parse_program(format_program({"p.csv", {{Pose{}, name, {}, 0}}}), "p.csv");
  EXPECT_EQ(read.waypoints[0].name, name);
  for (const char* other : {"PrePlace(BOX027)", "a~", "a~0.42", "a~0.42+", "a~0.42+x", "a~0.42+0.31x", "a~0+0.3",
                            "a~-1+0.3", "a~0.4+10", "a~nan+inf", "(a~0.42+0.31)", "a~+0.4+0.3", ""}) {
    EXPECT_EQ(swing_of(other), std::nullopt) << other;
  }
}

TEST(RowName, OfOursDoesNotMatchLimitsThatNameABoxOfTheDemonstrator) {
  const std::vector<NamedLimits> table = demonstrator_limits();
  EXPECT_EQ(match_limits(row_name("PrePlace", "BOX018"), table)->prefix, "PrePlace");
  EXPECT_EQ(match_limits(row_name("PrePlace", "018"), table)->prefix, "PrePlace");
  EXPECT_EQ(match_limits(row_name("PrePlace", "BOX018", "_2"), table)->prefix, "PrePlace");
  EXPECT_EQ(match_limits("PrePlace018", table)->prefix, "PrePlace018");
}

}  // namespace
}  // namespace snug::motion
