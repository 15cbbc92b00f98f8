// Words of a command: split as a shell would, and nothing else of a shell.
#include "snug/frames/internal/words.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"

namespace snug::frames::internal {
namespace {

using Words = std::vector<std::string>;

TEST(CommandWords, AreSplitAtBlanksAndKeptInQuotes) {
  EXPECT_EQ(split_command("  take  -o\t{frame}.png "), (Words{"take", "-o", "{frame}.png"}));
  EXPECT_EQ(split_command("a 'b c' \"d e\""), (Words{"a", "b c", "d e"}));
  EXPECT_EQ(split_command("a b\\ c 'd\\' \"\\\"e\\\\f\\g\""), (Words{"a", "b c", "d\\", "\"e\\f\\g"}));
  EXPECT_EQ(split_command("a '' b''c"), (Words{"a", "", "bc"}));
  EXPECT_EQ(split_command("sh -c 'x | y > z; exit $?'"), (Words{"sh", "-c", "x | y > z; exit $?"}));
}

TEST(CommandWords, MeanNothingMoreThanThemselves) {
  EXPECT_EQ(split_command("echo $HOME *.png ~ a=b"), (Words{"echo", "$HOME", "*.png", "~", "a=b"}));
}

TEST(CommandWords, ThatAskForAShellAreRefused) {
  for (const char* text :
       {"a | b", "a > b", "a && b", "a; b", "a $(b)", "a `b`", "a &", "", "   ", "a 'b", "a \"b", "a \\"})
    EXPECT_THROW((void)split_command(text), InputError) << text;
  EXPECT_NO_THROW((void)split_command("a '|' \\; '$(b)'"));
}

TEST(CommandWords, AreFilledInOnce) {
  EXPECT_EQ(fill_in({"a", "-o{frame}.png", "{look}/{look}", "{time}", "{other}"}, "/tmp/{look}/f", 7, 1.5),
            (Words{"a", "-o/tmp/{look}/f.png", "7/7", "1.500000", "{other}"}));
}

TEST(CommandWords, NameAProgram) {
  EXPECT_EQ(find_program("/bin/sh"), "/bin/sh");
  EXPECT_FALSE(find_program("sh").empty());
  EXPECT_TRUE(find_program("no-such-program-anywhere").empty());
  EXPECT_TRUE(find_program("/etc/passwd").empty());
  EXPECT_TRUE(find_program("/tmp").empty());
}

}  // namespace
}  // namespace snug::frames::internal
