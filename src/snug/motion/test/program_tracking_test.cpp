// Tempo of a program: read back as written, comments passed over, refused where it is none.
#include "snug/motion/program_tracking.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::motion {
namespace {

const std::string kTempoRow = "0, 0, 0.5, 0, 3.14, 0,home,0,0,0,0,0,0\n";

TEST(ProgramTracking, ReadsBackAndLeavesTheRowsAlone) {
  for (const double tempo : {0.5, 0.1, 1.0, 0.77}) {
    const std::string text = format_tracking(FastTracking{tempo}) + kTempoRow;
    EXPECT_EQ(find_tracking(text, "p.csv"), Tracking(FastTracking{tempo}));
    EXPECT_EQ(parse_program(text, "p.csv").waypoints.front().X_WE,
              parse_program(kTempoRow, "p.csv").waypoints.front().X_WE);
    EXPECT_EQ(parse_program(text, "p.csv").waypoints.front().line, 2);
  }
}

TEST(ProgramTracking, IsNoneWithoutOneAndInOtherComments) {
  EXPECT_TRUE(is_lagged(find_tracking(kTempoRow, "p.csv")));
  EXPECT_TRUE(is_lagged(find_tracking("# made by hand\n#\n" + kTempoRow, "p.csv")));
  EXPECT_EQ(find_tracking(kTempoRow + "  #  tempo:  0.6  \r\n", "p.csv"), Tracking(FastTracking{0.6}));
}

TEST(ProgramTracking, IsRefusedOutOfRangeNotANumberAndTwice) {
  for (const char* bad : {"# tempo: 0\n", "# tempo: 1.01\n", "# tempo: nan\n", "# tempo: fast\n", "# tempo:\n",
                          "# tempo: 0.5 s\n", "# tempo: 0.5\n# tempo: 0.5\n"}) {
    EXPECT_THROW((void)find_tracking(bad + kTempoRow, "p.csv"), InputError) << bad;
  }
  try {
    (void)find_tracking(kTempoRow + "# tempo: 7\n", "p.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("p.csv:2"), std::string::npos) << error.what();
  }
}

TEST(ProgramTracking, IsReadInCapitalsAndWithBlanksAndBehindAByteOrderMark) {
  for (const char* text :
       {"# tempo : 0.6\n", "#tempo:0.6\n", "# Tempo: 0.6\n", "# TEMPO :0.6\n", "\xEF\xBB\xBF# tempo: 0.6\n"}) {
    EXPECT_EQ(find_tracking(text + kTempoRow, "p.csv"), Tracking(FastTracking{0.6})) << text;
  }
}

TEST(ProgramTracking, IsRefusedMisspeltWithItsLineAndTheRightSpelling) {
  for (const char* bad :
       {"# tmepo: 1\n", "# temp: 0.5\n", "# Tempoo : 1\n", "# tempo = 1\n", "# tempo 0.8\n", "# tepo=1\n"}) {
    try {
      (void)find_tracking(kTempoRow + bad, "p.csv");
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("p.csv:2"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("'# tempo: NUMBER'"), std::string::npos) << error.what();
    }
  }
}

TEST(ProgramTracking, IsNoneInCommentsThatAreOfSomethingElse) {
  for (const char* other : {"# boxes: 12\n", "# temp: cold\n", "# tempo of the day: slow\n", "# demo 1\n", "# 2: 1\n",
                            "# : 1\n", "# time: 250.3\n"}) {
    EXPECT_EQ(find_tracking(other + kTempoRow, "p.csv"), Tracking(LaggedTracking{})) << other;
  }
}

TEST(ProgramTracking, AFileOfCommentsAloneIsNoProgram) {
  EXPECT_THROW((void)parse_program("# tempo: 1\n", "p.csv"), InputError);
}

TEST(ProgramTracking, IsWrittenAndReadForEachKind) {
  for (const Tracking& tracking :
       {Tracking(LaggedTracking{}), Tracking(ExactTracking{}), Tracking(FastTracking{0.1}), Tracking(FastTracking{})}) {
    EXPECT_EQ(find_tracking(format_tracking(tracking) + kTempoRow, "p.csv"), tracking) << name_of(tracking);
  }
  EXPECT_EQ(find_tracking("# Tracking: LAGGED\n" + kTempoRow, "p.csv"), Tracking(LaggedTracking{}));
  for (const char* bad : {"# tracking: fast\n", "# tracking: ideal\n", "# tracking: 1\n", "# tracking:\n",
                          "# tracking: exact\n# tempo: 1\n"}) {
    EXPECT_THROW((void)find_tracking(bad + kTempoRow, "p.csv"), InputError) << bad;
  }
}

TEST(ProgramTracking, SaysWithWhichRobot) {
  const Program program = parse_program("# tempo: 1\n# Robot : ur10\n" + kTempoRow, "p.csv");
  EXPECT_EQ(program.robot, "ur10");
  EXPECT_EQ(parse_program(format_program(program), "p.csv").robot, "ur10");
  EXPECT_EQ(find_robot("# robot: that of the second hall\n# robot:\n# robots: a\n" + kTempoRow, "p.csv"), "");
  EXPECT_EQ(format_program({"p.csv", program.waypoints}).find("robot"), std::string::npos);
  EXPECT_THROW((void)parse_program("# robot: a\n# robot: b\n" + kTempoRow, "p.csv"), InputError);
}

TEST(ProgramTracking, IsWhatTheUserAsksForElseWhatTheProgramWasMadeFor) {
  const Tracking made_for = FastTracking{0.6};
  const auto choose = [&](std::optional<std::string> word, std::optional<double> tempo) {
    return choose_tracking(word, tempo, made_for, "test");
  };
  EXPECT_EQ(choose({}, {}), made_for);
  EXPECT_EQ(choose("lagged", {}), Tracking(LaggedTracking{}));
  EXPECT_EQ(choose("exact", {}), Tracking(ExactTracking{}));
  EXPECT_EQ(choose("fast", {}), made_for);
  EXPECT_EQ(choose("fast", 0.8), Tracking(FastTracking{0.8}));
  EXPECT_EQ(choose({}, 0.8), Tracking(FastTracking{0.8}));
  EXPECT_EQ(choose_tracking("fast", {}, LaggedTracking{}, "test"), Tracking(FastTracking{1.0}));
  for (const char* old : {"faithful", "ideal"}) {
    try {
      (void)choose(old, {});
      ADD_FAILURE() << old;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("lagged, exact or fast"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace snug::motion
