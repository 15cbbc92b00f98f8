// Tempo of a program: read back as written, comments passed over, refused where it is none.
#include "snug/motion/program_tempo.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::motion {
namespace {

const std::string kTempoRow = "0, 0, 0.5, 0, 3.14, 0,home,0,0,0,0,0,0\n";

TEST(ProgramTempo, ReadsBackAndLeavesTheRowsAlone) {
  for (const double tempo : {0.5, 0.1, 1.0, 0.77}) {
    const std::string text = format_tempo(tempo) + kTempoRow;
    EXPECT_EQ(find_tempo(text, "p.csv"), tempo);
    EXPECT_EQ(parse_program(text, "p.csv").waypoints.front().X_WE(),
              parse_program(kTempoRow, "p.csv").waypoints.front().X_WE());
    EXPECT_EQ(parse_program(text, "p.csv").waypoints.front().line, 2);
  }
}

TEST(ProgramTempo, IsNoneWithoutOneAndInOtherComments) {
  EXPECT_FALSE(find_tempo(kTempoRow, "p.csv"));
  EXPECT_FALSE(find_tempo("# made by hand\n#\n" + kTempoRow, "p.csv"));
  EXPECT_EQ(find_tempo(kTempoRow + "  #  tempo:  0.6  \r\n", "p.csv"), 0.6);
}

TEST(ProgramTempo, IsRefusedOutOfRangeNotANumberAndTwice) {
  for (const char* bad : {"# tempo: 0\n", "# tempo: 1.01\n", "# tempo: nan\n", "# tempo: fast\n", "# tempo:\n",
                          "# tempo: 0.5 s\n", "# tempo: 0.5\n# tempo: 0.5\n"}) {
    EXPECT_THROW((void)find_tempo(bad + kTempoRow, "p.csv"), InputError) << bad;
  }
  try {
    (void)find_tempo(kTempoRow + "# tempo: 7\n", "p.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("p.csv:2"), std::string::npos) << error.what();
  }
}

TEST(ProgramTempo, IsReadInCapitalsAndWithBlanksAndBehindAByteOrderMark) {
  for (const char* text :
       {"# tempo : 0.6\n", "#tempo:0.6\n", "# Tempo: 0.6\n", "# TEMPO :0.6\n", "\xEF\xBB\xBF# tempo: 0.6\n"}) {
    EXPECT_EQ(find_tempo(text + kTempoRow, "p.csv"), 0.6) << text;
  }
}

TEST(ProgramTempo, IsRefusedMisspeltWithItsLineAndTheRightSpelling) {
  for (const char* bad :
       {"# tmepo: 1\n", "# temp: 0.5\n", "# Tempoo : 1\n", "# tempo = 1\n", "# tempo 0.8\n", "# tepo=1\n"}) {
    try {
      (void)find_tempo(kTempoRow + bad, "p.csv");
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("p.csv:2"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("'# tempo: NUMBER'"), std::string::npos) << error.what();
    }
  }
}

TEST(ProgramTempo, IsNoneInCommentsThatAreOfSomethingElse) {
  for (const char* other : {"# boxes: 12\n", "# temp: cold\n", "# tempo of the day: slow\n", "# demo 1\n", "# 2: 1\n",
                            "# : 1\n", "# time: 250.3\n"}) {
    EXPECT_EQ(find_tempo(other + kTempoRow, "p.csv"), std::nullopt) << other;
  }
}

TEST(ProgramTempo, AFileOfCommentsAloneIsNoProgram) {
  EXPECT_THROW((void)parse_program("# tempo: 1\n", "p.csv"), InputError);
}

}  // namespace
}  // namespace snug::motion
