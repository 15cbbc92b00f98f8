// Waypoint names: whole ids of any form come back from the names of our own; numbers are those of the demonstrator.
#include "snug/motion/waypoint_name.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/motion/limits.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

TEST(WaypointName, IsForItsBoxAloneWhateverTheIdsAreLike) {
  // Ids that are parts of each other, look like numbers, suffixes or names of rows, or hold brackets and blanks.
  const std::vector<std::string> ids{"1",       "11",         "BOX11",    "BOX1",    "BOX011", "Box11", "A12B",
                                     "crate",   "crate_turn", "_2",       "(",       ")",      "a)b",   "(a)",
                                     "a)_turn", "Slow",       "Box",      "PrePick", "a b ",   "ü/√ 1", "018",
                                     "BOX018",  "Box(1)",     "ITEM0001", "a_2",     "a",      "a_"};
  Program program{"p.csv", {}};
  std::vector<std::string> meant;
  for (const std::string& id : ids) {
    for (const char* suffix : {"", "_2", "_turn", "_turn_around"}) {
      program.waypoints.push_back(make_waypoint(MotionClass::PrePick, id, Pose{}, {}, suffix));
      meant.push_back(id);
    }
  }
  const Program read = parse_program(format_program(program), "p.csv");
  ASSERT_EQ(read.waypoints.size(), meant.size());
  for (std::size_t i = 0; i < meant.size(); ++i) {
    const Waypoint& row = read.waypoints[i];
    SCOPED_TRACE(name_of(row));
    EXPECT_EQ(row.item, meant[i]);
    EXPECT_EQ(row.variant, program.waypoints[i].variant);
    EXPECT_EQ(row.motion_class, MotionClass::PrePick);
    for (const std::string& id : ids) EXPECT_EQ(fit_of(row, id) > 0, id == meant[i]) << id;
  }
}

TEST(WaypointName, WithAnEmptyIdIsKeptAsItIs) {
  for (const char* name : {"PrePick()", "PrePick()_turn", "Place()e~", "Box(a"}) {
    const Waypoint read = parse_waypoint_name(name);
    EXPECT_EQ(name_of(read), name);
    EXPECT_EQ(parse_waypoint_name(name_of(read)), read) << name;
  }
}

/// 0 as well where it is no PrePick.
std::size_t fit_of_pick(const std::string& name, const std::string& id) {
  const Waypoint waypoint = parse_waypoint_name(name);
  return waypoint.motion_class == MotionClass::PrePick ? fit_of(waypoint, id) : 0;
}

TEST(WaypointName, OfTheDemonstratorNamesTheBoxOfThatNumber) {
  for (const char* row : {"PrePick027", "PrePick027_seq3", "PrePick_027", "PrePickBox027", "PrePickBOX027"}) {
    EXPECT_GT(fit_of_pick(row, "BOX027"), 0U) << row;
    EXPECT_EQ(fit_of_pick(row, "BOX0027"), 0U) << row;
    EXPECT_EQ(fit_of_pick(row, "BOX7"), 0U) << row;
    EXPECT_EQ(fit_of_pick(row, "B027"), 0U) << row;
    EXPECT_EQ(name_of(parse_waypoint_name(row)), row);
  }
  EXPECT_EQ(fit_of_pick("PrePick1", "BOX11"), 0U);
  EXPECT_EQ(fit_of_pick("PrePick0271", "BOX027"), 0U);
  EXPECT_EQ(fit_of_pick("PrePick", "BOX027"), 0U);
  EXPECT_EQ(fit_of_pick("", "BOX027"), 0U);
  EXPECT_EQ(fit_of_pick("PrePick(BOX027", "BOX027"), 0U);
  EXPECT_EQ(fit_of_pick("Box027", "BOX027"), 0U);
}

TEST(WaypointName, WrittenBareByHandIsForTheLongestIdAndWholeIdsBeforeNumbers) {
  EXPECT_GT(fit_of_pick("PrePickA12B", "A12B"), 0U);
  EXPECT_GT(fit_of_pick("PrePickcrate_2", "crate_2"), fit_of_pick("PrePickcrate_2", "crate"));
  EXPECT_EQ(fit_of_pick("PrePickcrates", "crate"), 0U);
  EXPECT_GT(fit_of_pick("PrePick027", "027"), fit_of_pick("PrePick027", "BOX027"));
}

TEST(WaypointName, BeginsWithTheLongestClassThatFits) {
  const auto class_of = [](const char* name) { return parse_waypoint_name(name).motion_class; };
  EXPECT_EQ(class_of("Place028_2"), MotionClass::Place);
  EXPECT_EQ(class_of("PlaceSlow(BOX028)_push"), MotionClass::PlaceSlow);
  EXPECT_EQ(class_of("PlaceBox028"), MotionClass::Place);
  EXPECT_EQ(class_of("TwistDrag(BOX028)"), MotionClass::TwistDrag);
  EXPECT_EQ(class_of("Twist028"), MotionClass::Twist);
  EXPECT_EQ(class_of("home_around"), MotionClass::Home);
  for (const char* other : {"midpoint", "PreRepick016_2", "place", "Row", "~", "Move(BOX1)"}) {
    EXPECT_EQ(class_of(other), MotionClass::Other) << other;
    EXPECT_EQ(name_of(parse_waypoint_name(other)), other);
  }
}

TEST(WaypointName, SaysWhatTouches) {
  for (const char* touching : {"Box027", "RePick027", "Place027", "PlaceSlow027", "Twist027", "TwistDrag027"}) {
    EXPECT_TRUE(is_contact(parse_waypoint_name(touching).motion_class)) << touching;
  }
  for (const char* free : {"PrePick027", "PostPick027", "PreRePick027", "PostRePick027", "PreTwist027", "PrePlace027",
                           "PostPlace027", "home", "midpoint", "PreRepick027"}) {
    EXPECT_FALSE(is_contact(parse_waypoint_name(free).motion_class)) << free;
  }
}

TEST(WaypointName, SaysHowTheBoxOnTheWaySwings) {
  Waypoint waypoint = make_waypoint(MotionClass::PrePlace, "BOX027", Pose{});
  waypoint.swing = Swing{0.42, 0.31};
  EXPECT_EQ(name_of(waypoint), "PrePlace(BOX027)~0.42+0.31");
  EXPECT_EQ(parse_waypoint_name(name_of(waypoint)), waypoint);
  waypoint.variant = "_turn";
  EXPECT_EQ(name_of(waypoint), "PrePlace(BOX027)_turn~0.42+0.31");
  EXPECT_EQ(parse_waypoint_name("PrePlace(BOX027)~0.42+0.31_turn"), waypoint) << "as earlier programs have it";
  const Program read = parse_program(format_program({"p.csv", {waypoint}}), "p.csv");
  EXPECT_EQ(read.waypoints[0].swing, waypoint.swing);
  EXPECT_EQ(as_named({0.1234, 1.0}), (Swing{0.12, 1.0}));
  EXPECT_EQ(as_named({0.42, 0.31, 0.704}).pace, 0.70);
  for (const char* other : {"PrePlace(BOX027)", "a~", "a~0.42", "a~0.42+", "a~0.42+x", "a~0.42+0.31x", "a~0+0.3",
                            "a~-1+0.3", "a~0.4+10", "a~nan+inf", "(a~0.42+0.31)", "a~+0.4+0.3", ""}) {
    EXPECT_EQ(parse_waypoint_name(other).swing, std::nullopt) << other;
    EXPECT_EQ(name_of(parse_waypoint_name(other)), other);
  }
}

TEST(WaypointName, SaysAtWhichPaceAHeavyBoxIsCarried) {
  Waypoint waypoint = make_waypoint(MotionClass::PrePlace, "BOX027", Pose{});
  waypoint.swing = Swing{0.42, 0.31, 0.7};
  EXPECT_EQ(name_of(waypoint), "PrePlace(BOX027)~0.42+0.31*0.70");
  EXPECT_EQ(parse_waypoint_name(name_of(waypoint)), waypoint);
  EXPECT_EQ(parse_waypoint_name("PrePlace(BOX027)~0.42+0.31*1").swing, (Swing{0.42, 0.31}));
  const Program read = parse_program(format_program({"p.csv", {waypoint}}), "p.csv");
  EXPECT_EQ(read.waypoints[0].swing, waypoint.swing);
}

TEST(WaypointName, SaysWhenItMayBegin) {
  Waypoint waypoint = make_waypoint(MotionClass::PrePlace, "BOX@7", Pose{});
  waypoint.not_before = 7.512;
  EXPECT_EQ(name_of(waypoint), "PrePlace(BOX@7)@7.512");
  EXPECT_EQ(parse_waypoint_name(name_of(waypoint)), waypoint);
  waypoint.variant = "_turn";
  waypoint.swing = Swing{0.42, 0.31, 0.7};
  EXPECT_EQ(name_of(waypoint), "PrePlace(BOX@7)_turn~0.42+0.31*0.70@7.512");
  const Program read = parse_program(format_program({"p.csv", {waypoint}}), "p.csv");
  EXPECT_EQ(read.waypoints[0].not_before, 7.512);
  EXPECT_EQ(name_of(read.waypoints[0]), name_of(waypoint));
  EXPECT_EQ(parse_waypoint_name("home@0.0004").not_before, std::nullopt) << "at the start";
  EXPECT_EQ(as_named(7.5126), 7.513);
  EXPECT_EQ(as_named(0.0), std::nullopt);
  for (const char* other : {"a@", "a@b", "PrePick(a@3)", "home@3x", "@", "a@3@"}) {
    EXPECT_EQ(parse_waypoint_name(other).not_before, std::nullopt) << other;
    EXPECT_EQ(name_of(parse_waypoint_name(other)), other);
    EXPECT_FALSE(has_malformed_instant(parse_waypoint_name(other))) << other;
  }
  for (const char* refused : {"home@-1", "home@nan", "Place(B)@7200.1", "Place027@1e9", "a@1e999", "a@inf"}) {
    SCOPED_TRACE(refused);
    EXPECT_TRUE(has_malformed_instant(parse_waypoint_name(refused)));
    EXPECT_THROW((void)parse_program(std::string("0,0,0.5,0,3.14,0,") + refused + ",0,0,0,0,0,0\n", "p.csv"),
                 InputError);
    EXPECT_THROW((void)format_program({"p.csv", {parse_waypoint_name(refused)}}), InputError);
  }
}

TEST(WaypointName, WithAMalformedSwingIsRefusedByFiles) {
  for (const char* name :
       {"PostPick(BOX027)~nan+0", "PostPick(BOX027)~99999+-3", "PrePlace(B)~0.42", "PrePlace(B)~0.42+",
        "PrePlace(B)~+0.4", "PrePlace(B)~0.42+0.31x", "Place(B)~0.4+10_turn", "Place(B)_2~0+0.3", "Place027~inf+1",
        "home~1e999", "Place(B)~nan+0~0.42+0.31", "Place(B)~0.42+0.31*", "Place(B)~0.42+0.31*1.1",
        "Place(B)~0.42+0.31*0", "Place(B)~0.42+0.31*0.009", "Place(B)~0.42+0.31*nan"}) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(has_malformed_swing(parse_waypoint_name(name)));
    const std::string row = std::string("0,0,0.5,0,3.14,0,") + name + ",0,0,0,0,0,0\n";
    try {
      (void)parse_program("# a comment\n" + row, "p.csv");
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("p.csv:2"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("~0.42+0.31"), std::string::npos) << error.what();
    }
    EXPECT_THROW((void)format_program({"p.csv", {parse_waypoint_name(name)}}), InputError);
  }
  for (const char* name :
       {"PrePlace(BOX027)~0.42+0.31_turn", "Place()e~", "a~", "Place(a~1)", "Place(a~b+c)_2", "a~b"}) {
    EXPECT_FALSE(has_malformed_swing(parse_waypoint_name(name))) << name;
  }
}

TEST(WaypointName, OfOursDoesNotMatchLimitsThatNameABoxOfTheDemonstrator) {
  const std::vector<NamedLimits> table = demonstrator_limits();
  EXPECT_EQ(match_limits(name_of(make_waypoint(MotionClass::PrePlace, "BOX018", Pose{})), table)->prefix, "PrePlace");
  EXPECT_EQ(match_limits(name_of(make_waypoint(MotionClass::PrePlace, "018", Pose{})), table)->prefix, "PrePlace");
  EXPECT_EQ(match_limits(name_of(make_waypoint(MotionClass::PrePlace, "BOX018", Pose{}, {}, "_2")), table)->prefix,
            "PrePlace");
  EXPECT_EQ(match_limits("PrePlace018", table)->prefix, "PrePlace018");
}

}  // namespace
}  // namespace snug::motion
